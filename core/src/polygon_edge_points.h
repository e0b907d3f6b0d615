// SPDX-License-Identifier: MIT
//
// Regions bounded by circular arcs, by Stokes' theorem and Gauss points on the arcs (docs/algorithms.md, "Polygons").
// T is float or double; everything runs in double for either.
#pragma once

#include "polygon_region.h"

namespace shlight {

/// order² coefficients.
template <class T>
void edge_point_coefficients(const PolygonRegion<Wider<T>>& region, int order, T* coefficients);

/// Σ f_lm L_lm with a lobe's cosine terms, cosine_count(order) values.
template <class T>
T shade_by_edge_points(const PolygonRegion<Wider<T>>& region, const T* lobe_terms, int order);

/// Gauss points on all arcs together that these take: more for long arcs and high orders.
template <class T>
int edge_points(const PolygonRegion<Wider<T>>& region, int order);

}  // namespace shlight
