// SPDX-License-Identifier: MIT
#pragma once

#include "spherical_polygon.h"

namespace shlight {

/// order² coefficients by Stokes' theorem, edge by edge (docs/algorithms.md, "Polygons").
template <class T>
void polygon_by_boundary(const SphericalPolygon<Wider<T>>& polygon, int order, T* coefficients);

}  // namespace shlight
