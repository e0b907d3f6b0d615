// SPDX-License-Identifier: MIT
//
// What may be passed as a polygon: checks that throw std::invalid_argument naming the argument.
#pragma once

#include <span>

#include "shlight/types.h"

namespace shlight {

/// At least 3.
void check_vertex_count(int vertex_count);

/// Finite, planar to the precision of T, in which the numbers were given, and none with the shading point on it: where
/// the rounding to T decides on which side of a polygon's plane it is, it lies outside. Many polygons of vertex_count
/// vertices.
template <class T>
void check_polygons(std::span<const Vec3d> vertices, int vertex_count);

}  // namespace shlight
