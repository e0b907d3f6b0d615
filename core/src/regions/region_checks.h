// SPDX-License-Identifier: MIT
//
// Checks of what may be passed as a sphere, a cap, a polygon or a disk. They throw std::invalid_argument, which names
// the argument.
#pragma once

#include <span>

#include "shlight/disk.h"
#include "shlight/types.h"

namespace shlight {

/// A positive radius, and a shading point that is not inside: contact within epsilon, the rounding of the inputs,
/// counts as contact.
void check_sphere(const Vec3d& center, double radius, double epsilon);
/// check_sphere for each of many; of floats the distance must be a normal float, too.
template <class T>
void check_spheres(std::span<const Vec3<T>> centers, std::span<const T> radii, double epsilon);

/// An axis that is finite and not zero, a half angle in (0, π] with room for rounding.
void check_cap(const Vec3d& axis, double half_angle);

/// At least 3.
void check_vertex_count(int vertex_count);

/// Throws unless all polygons, of vertex_count vertices each, are finite and planar to the precision of T, in which the
/// numbers were given, and none has the shading point on it. Where the rounding to T leaves open on which side of the
/// plane the shading point is, a polygon that bends around it by half a turn may be seen as half the sphere or more:
/// its vertices all become the first, and nothing is seen of it. In doubtful cases and in units beyond 1e±30 the
/// vertices are multiplied by a power of two, which changes nothing that is seen.
template <class T>
void prepare_polygons(std::span<Vec3d> vertices, int vertex_count);

/// Finite, with half axes that are independent to a few epsilon, the rounding of the numbers as they were given, and a
/// shading point that is not on the disk.
void check_disk(const Ellipse& disk, double epsilon);

}  // namespace shlight
