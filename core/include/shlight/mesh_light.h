// SPDX-License-Identifier: MIT
//
// Emissive faces of meshes as polygon lights.
#pragma once

#include <span>
#include <vector>

#include "shlight/ray_tracer.h"
#include "shlight/types.h"

namespace shlight {

/// The boundary of a face: three or four vertices with the winding of the triangles.
using FaceOutline = std::vector<Vec3d>;

/// Joins pairs of triangles that share an edge, lie in one plane and make a convex quadrilateral, so that a
/// quadrilateral face is one light and not two. Greedy: each triangle takes its first partner in the list, which for
/// meshes split by the usual triangulators is the other half of its face. Triangles without area are left out.
std::vector<FaceOutline> merge_faces(std::span<const Vec3d> vertices, std::span<const Triangle> triangles);

}  // namespace shlight
