// SPDX-License-Identifier: MIT
//
// Planar polygons seen from the shading point, clipped by the horizon z ≥ 0.
//
// Coefficients come from Stokes' theorem with Gauss points along the edges, or by Gauss cubature for polygons so small
// or thin that the edges would cancel. docs/theory.md, 4, derives both and says which is used when.
#pragma once

#include <span>

#include "shlight/types.h"

namespace shlight {

/// Coefficients of many polygons with the same number of vertices: count × order², row by row.
/// vertices: count × vertex_count, those of each polygon planar, in the shading frame, in either winding, as the
/// orientation does not matter. A polygon without area, or seen edge-on, has zero coefficients.
/// clip: keep only what lies above the horizon.
/// Throws std::invalid_argument naming the argument: order outside 1 … 64, fewer than 3 vertices, sizes that do not
/// fit, a non-finite number, vertices that are not planar, a shading point inside a polygon or on its outline (where
/// the rounding of the vertices leaves open on which side of the plane it lies).
template <class T>
void polygon_coefficients(std::span<const Vec3<T>> vertices, int vertex_count, int order, bool clip,
                          std::span<T> coefficients);

}  // namespace shlight
