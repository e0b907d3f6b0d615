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
    bool by_alpha = false;  ///< ∂(f·cos)/∂α in place of f·cos; a GgxShape only
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

/// An arc of directions ω = axis + cos ψ cosine + sin ψ sine with a parameter t: (1, cos ψ, sin ψ) is, up to a factor,
/// frame (r, flatness cos t, sin t), r = hypot(flatness cos t, sin t).
struct DirectionPath {
    Vec3d axis, cosine, sine;
    std::array<std::array<double, 3>, 3> frame;
    double flatness;
};

/// f·cos dψ/dt times 1, cos ψ and sin ψ.
using ArcDensity = std::array<double, 3>;

/// values[i] at t = parameters[i], at most kBoundaryPoints of them; 0 below the horizon.
void direction_densities(const LobeShape& shape, double cos_o, const DirectionPath& path,
                         std::span<const double> parameters, std::span<ArcDensity> values);

}  // namespace shlight
