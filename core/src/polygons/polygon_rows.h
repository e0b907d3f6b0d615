// SPDX-License-Identifier: MIT
//
// Coefficients of many polygons, and of regions whose arcs are known.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "polygons/arc_rows.h"
#include "shlight/types.h"

namespace shlight {

/// Coefficients of polygons to the precision of float. rows: order² numbers for each.
/// vertices: as polygon_coefficients has them.
/// Returns the numbers of those that are better integrated by cubature, whose rows are not written.
std::vector<std::uint32_t> polygon_rows(std::span<const Vec3d> vertices, int vertex_count, int order, bool clip,
                                        float* rows);

/// Adds what arcs have of bands 2 … to order² numbers for each region, row by row. great: all are of great circles.
void add_arc_coefficients(const ArcLists<float>& arcs, bool great, int order, float* coefficients);
void add_arc_coefficients(const ArcLists<double>& arcs, bool great, int order, double* coefficients);

}  // namespace shlight
