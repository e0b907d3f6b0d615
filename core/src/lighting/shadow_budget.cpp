// SPDX-License-Identifier: MIT
#include "lighting/shadow_budget.h"

#include <algorithm>
#include <cmath>

namespace shlight {

void ShadowBudget::start(const ShadingPoints& points, std::span<const UnshadowedLight> lights,
                         std::span<const std::uint32_t> penumbrae) {
    points_ = &points;
    penumbrae_ = penumbrae;
    const std::size_t groups = points.pixel_begin.size() - 1;
    all_.assign(groups, 0.0F);
    own_.assign(lights.size() * groups, 0.0F);
    for (std::size_t light = 0; light < lights.size(); ++light) {
        for (std::size_t group = 0; group < groups; ++group) {
            float& own = own_[light * groups + group];
            for (std::size_t point = points.pixel_begin[group]; point < points.pixel_begin[group + 1]; ++point) {
                own += of_point(lights[light], point);
            }
            all_[group] += own;
        }
    }
}

float ShadowBudget::of_point(const UnshadowedLight& light, std::size_t point) const {
    float sum = 0;
    for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
        sum += glm::dot(glm::abs(light[lobe * points_->size() + point]), glm::abs(points_->weight(point, lobe)));
    }
    return sum * static_cast<float>(points_->hit_count(point));
}

SampleRange ShadowBudget::samples_of(std::size_t light, std::size_t group, const SampleRange& samples) const {
    SampleRange own = samples;
    own.shadow_rays = std::clamp(static_cast<std::uint32_t>(std::ceil(rays(light, group, samples))),
                                 std::min(samples.shadow_rays, 1U), most_rays(light, group, samples));
    return own;
}

}  // namespace shlight
