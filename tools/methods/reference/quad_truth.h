// SPDX-License-Identifier: MIT
//
// References in 113-bit arithmetic, independent of the library's formulas: the basis by Laplace's integral, caps and
// polygons by quadrature over slices of constant z, whose longitude integral is closed.
//
//   ∫_R P̄_l^m(z) cos mφ dφ dz = ∮_∂R P̄_l^m(z) (sin mφ) / m dz   (m > 0),
//   ∫_R P̄_l^0(z) dφ dz       = ∮_∂R (∫_z^1 P̄_l^0 dz') dφ.
//
// Along an arc both integrands are trigonometric polynomials, so that Gauss–Legendre rules in the arc's angle converge
// faster than exponentially. No equation is solved, and no recurrence runs in m.
#pragma once

#include <span>
#include <vector>

#include "shlight/types.h"

namespace shlight::truth {

/// Reference values, each the unevaluated sum of two doubles.
struct Coefficients {
    std::vector<double> high, low;
};

/// The cap of half angle atan2(sin_half, cos_half) about an axis of any length, in doubles that are taken as exact.
struct CapInput {
    Vec3d axis;
    enum class Kind { sphere, facing_disk, angle } kind;
    double size;  ///< radius for the first two (the axis is then the centre), half angle [rad] for the third
};

/// order² coefficients of a cap. extra_nodes: added to the quadrature rules, to show that they have converged.
Coefficients cap(const CapInput& input, int order, bool clip, int extra_nodes = 0);

/// The same by double-exponential quadrature of P̄ (closed φ integral) over the colatitude, to check `cap`. Slow.
Coefficients cap_by_slices(const CapInput& input, int order, bool clip);

/// The part of a cap above a horizon of any height z_0 = cos atan2(sine, height); sine at least 1e-4.
Coefficients cap_above(const CapInput& input, double height, double sine, int order, int extra_nodes = 0);
Coefficients cap_above_by_slices(const CapInput& input, double height, double sine, int order);

/// The two numbers that define a shlight::Boost: it enlarges the neighbourhood of (-sin tilt, 0, cos tilt) by
/// (2 - narrowness) / narrowness.
struct BoostInput {
    double tilt, narrowness;
};

/// The image of a cap, clipped at z = 0, in the frame about the image of the upper hemisphere. The circles' images are
/// drawn through three mapped points each.
Coefficients boosted_cap(const CapInput& input, const BoostInput& boost, int order, int extra_nodes = 0);

/// order² coefficients of the region bounded by the great arcs through the vertices, taken with positive area.
Coefficients polygon(std::span<const Vec3d> vertices, int order, bool clip, int extra_nodes = 0);

/// The same by product Gauss cubature with nodes² points on each triangle of a fan, to check `polygon`.
Coefficients polygon_by_cubature(std::span<const Vec3d> vertices, int order, bool clip, int nodes);

/// The basis by Laplace's integral P_l^m(cosθ) = (l+m)!/(l! π) ∫_0^π (cosθ + i sinθ cos t)^l i^{-m} cos mt dt,
/// exact by the trapezoidal rule.
Coefficients basis(const Vec3d& direction, int order);

/// The largest |computed - reference| over order² coefficients; NaN if any difference is.
template <class T>
double largest_error(const Coefficients& reference, int order, const T* computed);

}  // namespace shlight::truth
