// SPDX-License-Identifier: MIT
//
// What points of a light's boundary add to the integral of a lobe over it (boundary_integral.h), many at once.
#pragma once

#include <array>
#include <cstddef>
#include <glm/mat3x3.hpp>
#include <span>

#include "math/gauss_legendre.h"
#include "shlight/lobe_shape.h"
#include "shlight/types.h"

namespace shlight {

/// A lobe of a material, and what its f·cos counts in RGB.
struct WeightedLobe {
    LobeShape shape;
    std::array<double, 3> weight;
};

/// A lobe in the plane of the half vector's slopes.
struct SlopeNdf {
    LobeShape shape;
    double cos_o;           ///< cosθ_o
    const GaussRule* rule;  ///< along a radius
};

/// ∂(f·cos)/∂α of GGX lobes of one α, as that of SlopeNdf.
struct SlopeNdfByAlpha {
    std::span<const WeightedLobe> lobes;  ///< those of other shapes have none
    double alpha, cos_o;
    const GaussRule* rule;
    glm::dmat3 frame;  ///< columns: axes of the path, of which radii begin on the third
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

/// The same of all lobes, for RGB. path: in the axes of the frame.
void boundary_densities_by_alpha(const SlopeNdfByAlpha& slope_ndf, const BoundaryPath& path,
                                 std::span<const double> parameters, std::span<std::array<double, 3>> values);

/// An arc of directions ω = axis + cos ψ cosine + sin ψ sine with a parameter t: (1, cos ψ, sin ψ) is, up to a factor,
/// frame (r, flatness cos t, sin t), r = hypot(flatness cos t, sin t).
struct DirectionPath {
    Vec3d axis, cosine, sine;
    std::array<std::array<double, 3>, 3> frame;
    double flatness;
};

/// f·cos dψ/dt times 1, cos ψ and sin ψ, of R, of G and of B.
using ArcDensity = std::array<double, 9>;

/// The sums of all lobes, which have one lobe_width(): values[i] at t = parameters[i], at most kBoundaryPoints of them;
/// 0 below the horizon.
void direction_densities(std::span<const WeightedLobe> lobes, double cos_o, const DirectionPath& path,
                         std::span<const double> parameters, std::span<ArcDensity> values);

}  // namespace shlight
