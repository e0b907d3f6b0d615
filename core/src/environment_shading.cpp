// SPDX-License-Identifier: MIT
#include "environment_shading.h"

namespace shlight {

EnvironmentShading::EnvironmentShading(const Environment& environment, std::span<const MaterialLobes> materials,
                                       std::size_t lobe_stride)
    : environment_(&environment), materials_(materials), lobe_stride_(lobe_stride) {}

void EnvironmentShading::shade(const ShadingPoints& points, std::vector<Rgb>& values, RenderReport& report) const {
    values.assign(lobe_stride_ * points.size(), Rgb(0));
    for (std::size_t point = 0; point < points.size(); ++point) {
        const auto lobes = materials_[points.material[point]].lobes();
        for (std::size_t i = 0; i < lobes.size(); ++i) {
            // A constant is one harmonic, and a lobe's own first coefficient its albedo.
            const auto albedo = static_cast<float>(lobes[i].albedo(points.cos_theta_o[point]));
            values[i * points.size() + point] = albedo * environment_->radiance(points.frame[point].z);
            (is_mirror(lobes[i].shape) ? report.mirror_count : report.order_counts[1]) += points.hit_count(point);
        }
    }
}

}  // namespace shlight
