// SPDX-License-Identifier: MIT
//
// A polygon light that is clipped and measured once per hit, for all of the hit's lobes.
#pragma once

#include "polygon_region.h"

namespace shlight {

/// Σ f_lm L_lm of the polygon's image under the lobe's warp, for unit radiance. lobe_terms: cosine_count(order) values.
/// polygon: clipped by the true horizon. Without a warp small polygons are integrated by cubature; under a warp the
/// caller looks at PolygonRegion::solid_angle first and calls shade_region.
template <class T>
T shade_polygon(const SphericalPolygon<Wider<T>>& polygon, const Warp& warp, const T* lobe_terms, int order);

/// order² coefficients of a region bounded by arcs, by the faster of recurrences and Gauss points along them.
template <class T>
void region_coefficients(const PolygonRegion<Wider<T>>& region, int order, T* coefficients);

/// Σ f_lm L_lm with a lobe's cosine terms, cosine_count(order) values.
template <class T>
T shade_region(const PolygonRegion<Wider<T>>& region, const T* lobe_terms, int order);

}  // namespace shlight
