// SPDX-License-Identifier: MIT
//
// Faces that lie on others. Rays that begin on one of them in float meet the other or miss it, as rounding has it.
#pragma once

#include <cstdint>

#include "shlight/ray_tracer.h"
#include "shlight/surface_point.h"
#include "shlight/types.h"
#include "surfaces/placed_meshes.h"

namespace shlight {

/// Whether a face, which is not the one that was hit, lies on the hit's point, within the error of that point; its
/// edges do not count.
bool covers(const PlacedMeshes& placed, const RayHit& face, const RayHit& hit, const SurfacePoint& point);

enum class Cover : std::uint8_t {
    none,
    by_rounding,  ///< rounding has put the hit's place behind the face
    in_plane,     ///< both are in one plane to the last bit
};

/// How rays of Cycles that leave a hit to the side of `way` are stopped by a face that covers it: they begin at the
/// hit's place in float, and meet what is there at the distance 0. Precondition: triangles.
Cover cover_by(const PlacedMeshes& placed, const RayHit& face, const RayHit& hit, const Vec3d& way);

}  // namespace shlight
