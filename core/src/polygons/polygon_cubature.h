// SPDX-License-Identifier: MIT
#pragma once

#include "polygons/spherical_polygon.h"

namespace shlight {

/// order² coefficients by Gauss cubature on the polygon's triangles, to the precision of T for every size and shape.
template <class T>
void polygon_by_cubature(const SphericalPolygon<Wider<T>>& polygon, int order, T* coefficients);

}  // namespace shlight
