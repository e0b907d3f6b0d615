// SPDX-License-Identifier: MIT
//
// Materials lit by area lights, without shadows: Eq. 5 of Zhou & Wei 2020 in each lobe's warp, fused, with the cheapest
// way to integrate each light chosen for it.
#pragma once

#include <cstdint>
#include <span>

#include "shlight/bsdf.h"
#include "shlight/types.h"

namespace shlight {

struct ShadeSettings {
    int order = 0;            ///< 1 … 64: harmonics of this order for every light; 0: whatever meets the tolerance
    double tolerance = 1e-3;  ///< of the radiance ÷ the material's albedo at the view, in each colour channel
};

/// radiance[i]: reflected towards ω_o = (sinθ_o, 0, cosθ_o) of a sphere light of unit radiance; centres and radii in
/// the shading frame. effort: empty, or per light the largest order or number of cubature points that a lobe took; 0
/// where the light is hidden or mirrored. Throws std::invalid_argument naming the argument: sizes that do not fit, an
/// order outside 0 … 64, a tolerance ≤ 0 or not finite, cos_theta_o outside [0, 1], and as sphere_coefficients does.
void shade_spheres(std::span<const Vec3d> centers, std::span<const double> radii, const Bsdf& bsdf,
                   std::span<const double> cos_theta_o, const ShadeSettings& settings, std::span<Rgb> radiance,
                   std::span<std::int32_t> effort = {});

/// The same for planar polygons of vertex_count vertices each, in either winding; throws as polygon_coefficients does.
void shade_polygons(std::span<const Vec3d> vertices, int vertex_count, const Bsdf& bsdf,
                    std::span<const double> cos_theta_o, const ShadeSettings& settings, std::span<Rgb> radiance,
                    std::span<std::int32_t> effort = {});

}  // namespace shlight
