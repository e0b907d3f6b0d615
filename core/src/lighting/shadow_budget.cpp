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
    of_points_.resize(points.size());
    find_weights();
    for (std::size_t light = 0; light < lights.size(); ++light) {
        find_points(lights[light]);
        for (std::size_t group = 0; group < groups; ++group) {
            float& own = own_[light * groups + group];
            for (std::size_t point = points.pixel_begin[group]; point < points.pixel_begin[group + 1]; ++point) {
                own += of_points_[point];
            }
            all_[group] += own;
        }
    }
}

void ShadowBudget::find_weights() {
    const std::size_t size = points_->size();
    weights_.resize(3 * lobe_stride_ * size);
    for (std::size_t i = 0; i < lobe_stride_ * size; ++i) {
        const Rgb weight = glm::abs(points_->weight(i % size, i / size));
        float* own = &weights_[3 * (i - i % size) + i % size];
        own[0] = weight.x;
        own[size] = weight.y;
        own[2 * size] = weight.z;
    }
}

/// The same numbers as of_point(), which does not fit vectors.
void ShadowBudget::find_points(const UnshadowedLight& light) {
    const std::size_t size = points_->size();
    const auto& [values, strength, strengths] = light.smooth;
    if (light.environment != nullptr || !strengths.empty()) {
        for (std::size_t point = 0; point < size; ++point) {
            of_points_[point] = of_point(light, point);
        }
        return;
    }
    std::ranges::fill(of_points_, 0.0F);
    for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
        const float* value = values.data() + lobe * size;
        const float* weight = weights_.data() + 3 * lobe * size;
        for (std::size_t point = 0; point < size; ++point) {
            of_points_[point] += std::abs(value[point] * strength.x) * weight[point] +
                                 std::abs(value[point] * strength.y) * weight[size + point] +
                                 std::abs(value[point] * strength.z) * weight[2 * size + point];
        }
    }
    for (std::size_t point = 0; point < size; ++point) {
        of_points_[point] *= static_cast<float>(points_->hit_count(point));
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
