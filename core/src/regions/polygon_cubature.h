// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "shlight/types.h"

namespace shlight {

/// order² coefficients of a polygon by Gauss cubature on its triangles, to the precision of double for every size and
/// shape. Slow where the polygon is large: for those whose edges would cancel (docs/theory.md, 4.6).
/// vertices: as polygon_coefficients has them, seen neither edge-on nor without area.
template <class T>
void polygon_by_cubature(std::span<const Vec3d> vertices, int order, bool clip, T* coefficients);

}  // namespace shlight
