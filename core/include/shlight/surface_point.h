// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "shlight/types.h"

namespace shlight {

/// A point where a ray meets a surface; normals are turned to the side of the ray's origin.
struct SurfacePoint {
    Vec3d position;
    Vec3d geometric_normal;  ///< unit
    Vec3d shading_normal;    ///< unit; on the side of the geometric normal if MeshUse::turns_normals
    /// Bound of the distance between this point and the surface that rays in float meet here [m].
    double error;
    std::uint32_t material;

    /// Origin of rays that must not meet this surface, on the side of the ray that met it.
    Vec3d off_surface() const { return position + error * geometric_normal; }
};

}  // namespace shlight
