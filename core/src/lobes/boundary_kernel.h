// SPDX-License-Identifier: MIT
//
// What points of a light's boundary add to the integral of a lobe over it (boundary_integral.h), many at once.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "math/gauss_legendre.h"
#include "shlight/lobe_shape.h"
#include "shlight/types.h"

namespace shlight {

/// A lobe in the plane of the half vector's slopes.
struct SlopeNdf {
    LobeShape shape;
    double cos_o;           ///< cosθ_o
    const GaussRule* rule;  ///< along a radius
};

/// Half vectors along a circle: r middle + flatness cos τ cosine + sin τ sine, r = hypot(flatness cos τ, sin τ), with x
/// and y over the lobe's α. The three are at right angles, or nearly so, and nothing cancels in their sum.
struct BoundaryPath {
    Vec3d middle, cosine, sine;
    double flatness;
};

/// The most points of one call.
inline constexpr std::size_t kBoundaryPoints = 16;

/// values[i] at parameter τ_i = parameters[i], at most kBoundaryPoints of them. f32: in float, to some 1e-6 of the
/// lobe.
void boundary_densities(const SlopeNdf& slope_ndf, const BoundaryPath& path, bool f32,
                        std::span<const double> parameters, std::span<double> values);

}  // namespace shlight
