// SPDX-License-Identifier: MIT
//
// Regions bounded by circular arcs, by Stokes' theorem and Gauss points on the arcs (docs/algorithms.md, "Polygons").
// T is float or double; nearly everything runs in double for either. One region at a time: kernels/polygon_rows.h and
// polygon_shading_kernel.h take many.
#pragma once

#include "polygons/arc_rows.h"
#include "polygons/polygon_region.h"

namespace shlight {

/// Of a region bounded by great circles: bands 0 and 1 now, zeros for the others, and its arcs under its number into
/// lists, for add_arc_coefficients.
void start_edge_points(const PolygonRegion<long double>& region, int order, std::size_t number, ArcLists<double>& arcs,
                       double* coefficients);

/// order² coefficients.
template <class T>
void edge_point_coefficients(const PolygonRegion<Wider<T>>& region, int order, T* coefficients);

/// Σ f_lm L_lm with a lobe's cosine terms, cosine_count(order) values.
template <class T>
T shade_by_edge_points(const PolygonRegion<Wider<T>>& region, const T* lobe_terms, int order);

/// Whether the points go through the recurrences in float, twice as many at once. What edges cancel to is about solid
/// angle ÷ outline of what each has; great circles around a region with enough of that lose nothing that float could
/// hold: the result is right to 4e-6 of L_00 at every order.
template <class T>
bool edge_points_in_float(const PolygonRegion<Wider<T>>& region);

/// Gauss points on all arcs together that these take: more for long arcs and high orders.
template <class T>
int edge_points(const PolygonRegion<Wider<T>>& region, int order);

}  // namespace shlight
