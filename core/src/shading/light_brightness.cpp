// SPDX-License-Identifier: MIT
#include "shading/light_brightness.h"

namespace shlight {

void LightBrightness::start(const ShadingPoints& points, std::span<const float> others) {
    points_ = &points;
    all_.assign(others.begin(), others.end());
}

void LightBrightness::expect(std::span<const Light* const> lights, const DirectLight& unshadowed) {
    const std::size_t pixels = all_.size();
    own_.assign(lights.size() * pixels, 0.0F);
    for (std::size_t light = 0; light < lights.size(); ++light) {
        const LightRadiance values = unshadowed.light(light);
        for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
            float& own = own_[light * pixels + pixel];
            for (std::size_t point = points_->pixel_begin[pixel]; point < points_->pixel_begin[pixel + 1]; ++point) {
                own += of_point(values, point);
            }
            all_[pixel] += own;
        }
    }
}

}  // namespace shlight
