// SPDX-License-Identifier: MIT
//
// What may be passed as a light: checks that throw std::invalid_argument naming the argument.
#pragma once

#include <span>

#include "shlight/disk.h"
#include "shlight/types.h"
#include "spherical_polygon.h"

namespace shlight {

/// A positive radius, and a shading point that is not inside: contact within epsilon, the rounding of the inputs,
/// counts as contact.
void check_sphere(const Vec3d& center, double radius, double epsilon);
/// check_sphere of each of many: lanes tell where there is nothing to find.
template <class T>
void check_spheres(std::span<const Vec3<T>> centers, std::span<const T> radii, double epsilon);

/// An axis that is finite and not zero, a half angle in (0, π] with room for rounding.
void check_cap(const Vec3d& axis, double half_angle);

/// At least 3.
void check_vertex_count(int vertex_count);

/// Finite and planar to the precision of T, in which the vertices were given.
template <class T>
void check_polygon(std::span<const Vec3<Wider<T>>> vertices);
/// check_polygon<float> of each of many, of vertex_count vertices: lanes tell where there is nothing to find.
void check_polygons(std::span<const Vec3d> vertices, int vertex_count);
/// The same of polygons that were given in float, in less time; vertices: their numbers in double.
void check_polygons(std::span<const Vec3f> given, std::span<const Vec3d> vertices, int vertex_count);

/// Finite, with half axes that are independent to the precision of T, and a shading point that is not on the disk.
template <class T>
void check_disk(const Ellipse<Wider<T>>& disk);

}  // namespace shlight
