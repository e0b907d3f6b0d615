// SPDX-License-Identifier: MIT
//
// Integrates f·cos over a light along the light's boundary, for lobes that few bands do not describe. In the slopes s =
// (h_x, h_y) / (α h_z) of the half vector every GGX lobe has the same distribution 1/(π (1 + s²)²), for any roughness
// and view, times factors that vary slowly. Green's theorem turns the integral over the light's image in the plane of
// slopes into one along its boundary, of an integral over the radius. Small α makes neither narrow, grazing views only
// somewhat. A lobe without a peak is a factor of the distribution for α = 1, which is constant over the hemisphere.
// docs/theory.md, 6.5, derives it.
#pragma once

#include <array>
#include <span>

#include "lobes/boundary_kernel.h"
#include "regions/arcs.h"
#include "shlight/lobe_shape.h"
#include "shlight/types.h"

namespace shlight {

/// ∫ f·cos dω over a region of the upper hemisphere.
struct BoundaryIntegral {
    double value;
    double error;  ///< estimate
    int points;    ///< values of f·cos that it took
};

/// arcs: the whole boundary, in the shading frame. tolerance: absolute error of the value. albedo: of the lobe at this
/// view, or an upper estimate; errors of the radial rule and of float are relative to it.
/// Precondition: no mirror, 0 ≤ cos_theta_o ≤ 1.
BoundaryIntegral boundary_integral(const LobeShape& shape, double cos_theta_o, std::span<const Arc<double>> arcs,
                                   double tolerance, double albedo = 1);

/// ∫ ∂(f·cos)/∂α dω of RGB, to about 1e-6 of the largest of the three, or of 1e-5/α where they are less; mostly to
/// 1e-8. lobes: one or more of one lobe_width() α; those of shapes other than GGX have none.
std::array<double, 3> boundary_integral_by_alpha(std::span<const WeightedLobe> lobes, double cos_theta_o,
                                                 std::span<const Arc<double>> arcs);

}  // namespace shlight
