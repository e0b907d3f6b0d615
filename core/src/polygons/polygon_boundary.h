// SPDX-License-Identifier: MIT
//
// Regions bounded by circular arcs, by Stokes' theorem, arc by arc (docs/algorithms.md, "Polygons" and "Regions bounded
// by circular arcs"). T is float or double; the recurrences run in double for either.
#pragma once

#include "polygons/polygon_region.h"

namespace shlight {

/// order² coefficients.
template <class T>
void boundary_coefficients(const PolygonRegion<Wider<T>>& region, int order, T* coefficients);

/// Σ f_lm L_lm with a lobe's cosine terms, cosine_count(order) values.
template <class T>
T shade_by_boundary(const PolygonRegion<Wider<T>>& region, const T* lobe_terms, int order);

}  // namespace shlight
