// SPDX-License-Identifier: MIT
#include "tracing/hits.h"

namespace shlight {

void Hits::clear() {
    frame.clear();
    cos_theta_o.clear();
    shadow_origin.clear();
    terminator.clear();
    error.clear();
    material.clear();
    path.clear();
    lobe_weight.clear();
    lobe_forms.clear();
    sample.clear();
    radiance.clear();
    in_apart.clear();
    noise.clear();
    shared_noise.clear();
    visibility.clear();
    pixel_begin.assign(1, 0);
}

void Hits::add(const SurfacePoint& surface, const Terminator& terminator_there, const ShadingFrame& shading_frame,
               float view_cosine, std::span<const Rgb> weights, std::span<const LobeForm> forms,
               std::uint32_t sample_index, PathKind path_kind, std::uint32_t number_in_apart) {
    frame.push_back(shading_frame);
    cos_theta_o.push_back(view_cosine);
    // Shadow rays start on a ribbon, as in Cycles: Embree passes over flat curves within two radii of their origin.
    shadow_origin.push_back(surface.off_surface() - surface.lift);
    terminator.push_back(terminator_there);
    error.push_back(surface.error);
    material.push_back(surface.material);
    path.push_back(path_kind);
    lobe_weight.insert(lobe_weight.end(), weights.begin(), weights.end());
    lobe_weight.resize(size() * lobe_stride, Rgb(0));
    lobe_forms.insert(lobe_forms.end(), forms.begin(), forms.end());
    lobe_forms.resize(size() * lobe_stride);
    sample.push_back(sample_index);
    radiance.emplace_back(0);
    in_apart.push_back(number_in_apart);
    noise.emplace_back(0);
}

}  // namespace shlight
