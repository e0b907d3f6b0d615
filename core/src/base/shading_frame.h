// SPDX-License-Identifier: MIT
//
// The frame in which the light at a surface point is integrated.
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

/// The frame of a point with a normal, seen from direction `towards_viewer`; both unit vectors.
ShadingFrame shading_frame(const Vec3d& position, const Vec3d& normal, const Vec3d& towards_viewer);

/// Cosine of the angle between normal and viewer. A smooth normal may turn away from a grazing viewer; there the
/// surface is shaded as seen at a grazing angle.
float view_cosine(const ShadingFrame& frame, const Vec3d& towards_viewer);

}  // namespace shlight
