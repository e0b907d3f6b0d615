// SPDX-License-Identifier: MIT
//
// Planar polygons seen from the shading point, clipped by the horizon z ≥ 0.
//
// By Stokes' theorem along the edges: with Gauss points, or with recurrences in the degree where edges are long and the
// order is high; those so small or thin that the edges would cancel, by Gauss cubature. docs/algorithms.md derives all
// three and says where one hands over to the other.
#pragma once

#include <span>

#include "shlight/types.h"
#include "shlight/warp.h"

namespace shlight {

/// How a polygon is integrated; `automatic` is right except where the three are compared.
enum class PolygonMethod { automatic, boundary, edge_points, cubature };

/// Coefficients of one polygon, order² values.
/// vertices: k ≥ 3, planar, finite, in the shading frame, in either winding: the region counts, not its orientation.
/// A polygon without area, or seen edge-on, has zero coefficients.
/// clip: keep only what lies above the horizon.
template <class T>
void polygon_coefficients(std::span<const Vec3<T>> vertices, int order, bool clip, T* coefficients,
                          PolygonMethod method = PolygonMethod::automatic);

/// Many polygons with the same number of vertices.
/// vertices: count × vertex_count; coefficients: count × order², row by row.
/// Throws std::invalid_argument naming the argument: order outside 1 … 64, fewer than 3 vertices, sizes that do not
/// fit, a non-finite number, vertices that are not planar.
template <class T>
void polygon_coefficients(std::span<const Vec3<T>> vertices, int vertex_count, int order, bool clip,
                          std::span<T> coefficients, PolygonMethod method = PolygonMethod::automatic);

/// Coefficients of the image of a polygon under a warp, order² values in the warped frame. The polygon is clipped by
/// the true horizon first.
/// vertices: as above, in the shading frame, true directions.
/// Wrong by 1e-10 of L_00 at most where the image's solid angle Ω' is 10⁻³, in double and before the rounding to T, and
/// by 10⁻¹³ / Ω' in general: the arcs of a small image cancel. docs/algorithms.md has the figures by Ω'.
/// Precondition, not checked: 1 ≤ order ≤ kMaxOrder, finite vertices.
template <class T>
void warped_polygon_coefficients(std::span<const Vec3<T>> vertices, const Warp& warp, int order, T* coefficients);

/// Σ f_lm L_lm with a lobe's cosine terms f_lm, cosine_count(order) values: the reflection of unit radiance.
template <class T>
T shade_polygon(std::span<const Vec3<T>> vertices, const Warp& warp, const T* lobe_terms, int order);

}  // namespace shlight
