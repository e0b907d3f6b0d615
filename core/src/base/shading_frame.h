// SPDX-License-Identifier: MIT
//
// The frame of a surface point, in which its light is integrated.
#pragma once

#include "shlight/types.h"

namespace shlight {

/// Origin at the hit, z = shading normal, the viewer in the xz-plane at x ≥ 0.
struct ShadingFrame {
    Vec3d origin, x, y, z;

    Vec3d to_local(const Vec3d& world_vector) const {
        return {glm::dot(x, world_vector), glm::dot(y, world_vector), glm::dot(z, world_vector)};
    }
    Vec3d point_to_local(const Vec3d& world_point) const { return to_local(world_point - origin); }
    Vec3d to_world(const Vec3d& local_vector) const {
        return local_vector.x * x + local_vector.y * y + local_vector.z * z;
    }
};

/// The frame of a point; normal and towards_viewer are unit vectors.
ShadingFrame shading_frame(const Vec3d& position, const Vec3d& normal, const Vec3d& towards_viewer);

/// cosθ_o of unit vectors, at least 1e-4. An interpolated normal may turn away from a grazing viewer; the surface is
/// then shaded as seen at that grazing angle.
float view_cosine(const Vec3d& normal, const Vec3d& towards_viewer);

}  // namespace shlight
