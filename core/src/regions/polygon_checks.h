// SPDX-License-Identifier: MIT
//
// What may be passed as a polygon; std::invalid_argument names the argument that may not.
#pragma once

#include <span>

#include "shlight/types.h"

namespace shlight {

/// At least 3.
void check_vertex_count(int vertex_count);

/// Throws unless all polygons, of vertex_count vertices each, are finite and planar to the precision of T, in which the
/// numbers were given, and none has the shading point on it. Where the rounding to T leaves open on which side of the
/// plane the shading point is, a polygon that bends around it by half a turn may be seen as half the sphere or more:
/// its vertices all become the first, and nothing is seen of it. In doubtful cases and in units beyond 1e±30 the
/// vertices are multiplied by a power of two, which changes nothing that is seen.
template <class T>
void prepare_polygons(std::span<Vec3d> vertices, int vertex_count);

}  // namespace shlight
