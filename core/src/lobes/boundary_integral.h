// SPDX-License-Identifier: MIT
//
// A lobe integrated over a light along the light's boundary: cubature of the true f·cos, for lobes that few bands do
// not describe. Seen from the half vector every GGX lobe is the same bell, whatever its roughness and the view: with s
// = (h_x, h_y) / (α h_z) it is 1/(π (1 + s²)²), times factors that vary slowly. Green's theorem turns the integral over
// the light's image in that plane into one along its boundary, of a radial integral from the bell's middle. Small α
// makes neither narrow, grazing views only somewhat. A lobe without a peak is taken as a factor of the bell of α = 1,
// which is even. docs/theory.md, 6.5, derives it.
#pragma once

#include <span>

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

/// arcs: the whole boundary, in the shading frame. tolerance: of the value, absolute. albedo: of the lobe at this view,
/// as far as it is known; what a radial rule or floats err by is a share of it.
/// Precondition: no mirror, 0 ≤ cos_theta_o ≤ 1.
BoundaryIntegral boundary_integral(const LobeShape& shape, double cos_theta_o, std::span<const Arc<double>> arcs,
                                   double tolerance, double albedo = 1);

}  // namespace shlight
