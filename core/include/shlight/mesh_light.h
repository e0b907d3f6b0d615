// SPDX-License-Identifier: MIT
//
// Emissive faces of meshes as polygon lights.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "shlight/ray_tracer.h"
#include "shlight/types.h"

namespace shlight {

/// The boundary of a flat part of a mesh, with the winding of its triangles.
using FaceOutline = std::vector<Vec3d>;

/// Joins triangles that share edges and lie in one plane, so that a face is one light however finely it is divided.
/// Triangles without area are left out, and those of a part whose boundary is more than one line stay alone. Nothing:
/// the outlines would have more corners than `most_corners`.
std::optional<std::vector<FaceOutline>> merge_faces(std::span<const Vec3d> vertices,
                                                    std::span<const Triangle> triangles,
                                                    std::size_t most_corners = std::numeric_limits<std::size_t>::max());

}  // namespace shlight
