// SPDX-License-Identifier: MIT
//
// What may be passed as a polygon: checks that throw std::invalid_argument naming the argument.
#pragma once

#include <span>

#include "shlight/types.h"

namespace shlight {

/// At least 3.
void check_vertex_count(int vertex_count);

/// Finite and planar to the precision of T, in which the vertices were given.
template <class T>
void check_polygon(std::span<const Vec3<Wider<T>>> vertices);
/// check_polygon<float> of each of many, of vertex_count vertices: lanes tell where there is nothing to find.
void check_polygons(std::span<const Vec3d> vertices, int vertex_count);
/// The same of polygons that were given in float, in less time; vertices: their numbers in double.
void check_polygons(std::span<const Vec3f> given, std::span<const Vec3d> vertices, int vertex_count);

}  // namespace shlight
