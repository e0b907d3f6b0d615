// SPDX-License-Identifier: MIT
#include "lights/shadow_ray_spawner.h"

#include <variant>

#include "base/ray_rounding.h"

namespace shlight {

Vec3d target_offset(const Light& light, const ShadingFrame& frame) {
    const auto of_planar = [&](const auto& planar, const Vec3d& in_plane) {
        const double distance = planar.error + kRayRounding * glm::length(frame.origin - planar.center);
        const bool front = glm::dot(planar.normal, frame.origin - in_plane) > 0;
        return (front ? distance : -distance) * planar.normal;
    };
    if (const auto* disk = std::get_if<DiskLight>(&light)) {
        return of_planar(*disk, disk->center);
    }
    const auto* polygon = std::get_if<PolygonLight>(&light);
    return polygon != nullptr ? of_planar(*polygon, polygon->vertices[0]) : Vec3d(0);
}

}  // namespace shlight
