// SPDX-License-Identifier: MIT
#pragma once

#include "polygons/polygon_region.h"

namespace shlight {

/// Orders up to this have closed forms.
inline constexpr int kLowOrder = 4;

/// order² coefficients, order ≤ kLowOrder, of a region that is bounded by great circles: by Stokes' theorem, with the
/// integrals of polynomials of degree 1 and 2 along each edge in closed form (docs/algorithms.md, "Polygons").
template <class T>
void low_band_coefficients(const PolygonRegion<Wider<T>>& region, int order, T* coefficients);

}  // namespace shlight
