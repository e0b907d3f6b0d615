// SPDX-License-Identifier: MIT
//
// Coefficients of many polygons, and of regions whose arcs are known.
#pragma once

#include <span>

#include "regions/arc_rows.h"
#include "shlight/types.h"

namespace shlight {

/// Coefficients of polygons to the precision of T, float or double. rows: order² numbers for each.
/// vertices: as polygon_coefficients has them.
template <class T>
void polygon_rows(std::span<const Vec3d> vertices, int vertex_count, int order, bool clip, T* rows);

/// Adds what arcs of great circles have of bands 2 … to order² numbers for each region, row by row.
void add_arc_coefficients(const ArcLists<float>& arcs, int order, float* coefficients);
void add_arc_coefficients(const ArcLists<double>& arcs, int order, double* coefficients);

}  // namespace shlight
