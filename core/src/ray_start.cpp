// SPDX-License-Identifier: MIT
#include "ray_start.h"

#include <variant>

#include "ray_rounding.h"

namespace shlight {

Vec3d clearance(const Light& light, const ShadingFrame& frame) {
    const auto* polygon = std::get_if<PolygonLight>(&light);
    if (polygon == nullptr) {
        return Vec3d(0);
    }
    const double distance = polygon->error + kRayRounding * glm::length(frame.origin - polygon->center);
    const bool front = glm::dot(polygon->normal, frame.origin - polygon->vertices[0]) > 0;
    return (front ? distance : -distance) * polygon->normal;
}

}  // namespace shlight
