// SPDX-License-Identifier: MIT
//
// Disks and ellipses seen from the shading point, clipped by the horizon z ≥ 0.
//
// Seen from a point an ellipse is a cone of the second degree. With an elliptic function as the parameter of its
// boundary, Stokes' integral along the boundary converges exponentially for every position. Ellipses that are so small
// or thin that the boundary integral cancels are integrated along lines. docs/theory.md, 5, derives both.
#pragma once

#include <span>

#include "shlight/types.h"

namespace shlight {

/// The points centre + a u + b v with a² + b² ≤ 1, in the shading frame. u and v are any two conjugate half axes:
/// linearly independent, not necessarily perpendicular, in either order, as the orientation does not matter.
struct Ellipse {
    Vec3d center, half_axis_u, half_axis_v;
};

/// Coefficients of many disks: count × order², row by row. A disk seen edge-on has zero coefficients.
/// clip: keep only what lies above the horizon.
/// Throws std::invalid_argument naming the argument: order outside 1 … 64, sizes that do not fit, a non-finite number,
/// half axes that are dependent, a shading point inside a disk.
template <class T>
void disk_coefficients(std::span<const Vec3<T>> centers, std::span<const Vec3<T>> half_axes_u,
                       std::span<const Vec3<T>> half_axes_v, int order, bool clip, std::span<T> coefficients);

}  // namespace shlight
