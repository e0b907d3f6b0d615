// SPDX-License-Identifier: MIT
#include "tracing/hits.h"

namespace shlight {

void Hits::clear() {
    frame.clear();
    cos_theta_o.clear();
    shadow_origin.clear();
    error.clear();
    material.clear();
    lobe_weight.clear();
    sample.clear();
    radiance.clear();
    noise.clear();
    pixel_begin.assign(1, 0);
}

void Hits::add(const SurfacePoint& surface, std::span<const Lobe> lobes, const Vec3d& towards_viewer,
               const Rgb& emission, std::uint32_t sample_index) {
    frame.push_back(shading_frame(surface.position, surface.shading_normal, towards_viewer));
    cos_theta_o.push_back(view_cosine(frame.back(), towards_viewer));
    shadow_origin.push_back(surface.position + surface.error * surface.geometric_normal);
    error.push_back(surface.error);
    material.push_back(surface.material);
    for (std::size_t i = 0; i < lobe_stride; ++i) {
        lobe_weight.push_back(i < lobes.size() ? lobes[i].scale(cos_theta_o.back()) : Rgb(0));
    }
    sample.push_back(sample_index);
    radiance.push_back(emission);
    noise.emplace_back(0);
}

}  // namespace shlight
