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
    Vec3d lift{0};         ///< from a ribbon to the tube that it stands for
    double thickness = 0;  ///< of a tube or sphere: to its other side, against the normal

    /// Origin of rays that must not meet this surface, on the side of the ray that met it.
    Vec3d off_surface() const { return position + lift + error * geometric_normal; }
    /// The same on the other side.
    Vec3d behind_surface() const { return turned().off_surface(); }
    /// The point as the other side has it.
    SurfacePoint turned() const {
        const Vec3d other = lift - thickness * geometric_normal;
        return {position, -geometric_normal, -shading_normal, error, material, other, thickness};
    }
};

}  // namespace shlight
