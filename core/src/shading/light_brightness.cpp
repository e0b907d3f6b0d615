// SPDX-License-Identifier: MIT
#include "shading/light_brightness.h"

namespace shlight {

void LightBrightness::start(const ShadingPoints& points, std::span<const float> others) {
    points_ = &points;
    all_.assign(others.begin(), others.end());
    scales_.assign(lobe_stride_ * points.size(), Rgb(0));
    weights_.assign(lobe_stride_ * points.size(), Rgb(0));
    for (std::size_t point = 0; point < points.size(); ++point) {
        const std::span<const Lobe> lobes = materials_[points.material[point]].lobes();
        for (std::size_t lobe = 0; lobe < lobes.size(); ++lobe) {
            const std::size_t i = lobe * points.size() + point;
            scales_[i] = lobes[lobe].scale(points.cos_theta_o[point]);
            weights_[i] = static_cast<float>(points.hit_count(point)) * glm::abs(scales_[i]);
        }
    }
}

void LightBrightness::expect(std::span<const Light* const> lights, const DirectLight& unshadowed) {
    const std::size_t pixels = all_.size();
    own_.assign(lights.size() * pixels, 0.0F);
    for (std::size_t light = 0; light < lights.size(); ++light) {
        const Rgb& strength = strength_of(*lights[light]);
        const std::span<const float> values = unshadowed.light(light);
        for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
            float& own = own_[light * pixels + pixel];
            for (std::size_t point = points_->pixel_begin[pixel]; point < points_->pixel_begin[pixel + 1]; ++point) {
                own += of_point(strength, values, point);
            }
            all_[pixel] += own;
        }
    }
}

}  // namespace shlight
