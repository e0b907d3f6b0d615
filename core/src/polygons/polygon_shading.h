// SPDX-License-Identifier: MIT
//
// A polygon light that is clipped and measured once per hit, for all of the hit's lobes.
#pragma once

#include "polygons/polygon_region.h"

namespace shlight {

/// Σ f_lm L_lm of the polygon's image under the lobe's warp, for unit radiance. lobe_terms: cosine_count(order) values.
/// polygon: clipped by the true horizon. Without a warp small polygons are integrated by cubature.
template <class T>
T shade_polygon(const SphericalPolygon<Wider<T>>& polygon, const Warp& warp, const T* lobe_terms, int order);

}  // namespace shlight
