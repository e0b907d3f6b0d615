// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "shlight/ray_tracer.h"
#include "shlight/types.h"

namespace shlight {

/// A mesh whose vertices are distinct and used.
struct IndexedMesh {
    std::vector<Vec3d> vertices;
    std::vector<Triangle> faces;
};

/// Twice the area of a face long.
Vec3d scaled_normal(const IndexedMesh& mesh, const Triangle& face);

/// Vertices sorted by coordinates, each once, and the triangles that have an area. Vertices closer than `nearness`
/// times the extent are merged.
IndexedMesh welded(std::span<const Vec3d> vertices, std::span<const Triangle> triangles, double nearness);

}  // namespace shlight
