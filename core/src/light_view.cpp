// SPDX-License-Identifier: MIT
#include "light_view.h"

#include <algorithm>
#include <cmath>

namespace shlight {

std::optional<CapView> view(const SphereLight& light, const ShadingFrame& frame) {
    const Vec3d center = frame.point_to_local(light.center);
    const double distance = glm::length(center);
    if (light.facing_disk) {
        // The disk's upper rim: the centre's height plus the radius along the disk's steepest line.
        const double rim = center.z * distance + light.radius * std::hypot(center.x, center.y);
        if (distance > 0 && !(rim > 0)) {
            return std::nullopt;
        }
        return CapView{distance > 0 ? CapView::Kind::facing_disk : CapView::Kind::inside, center, light.radius};
    }
    if (distance <= light.radius) {
        return CapView{CapView::Kind::inside, center, light.radius};
    }
    if (!(center.z + light.radius > 0)) {
        return std::nullopt;
    }
    return CapView{CapView::Kind::sphere, center, light.radius};
}

bool is_seen(const PolygonLight& light, const ShadingFrame& frame, double error) {
    const double height = glm::dot(light.normal, frame.origin - light.vertices[0]);
    if (!((light.two_sided ? std::abs(height) : height) > 2 * (error + light.error))) {
        return false;
    }
    return std::any_of(light.vertices.begin(), light.vertices.end(),
                       [&](const Vec3d& v) { return glm::dot(frame.z, v - frame.origin) > 0; });
}

bool is_seen(const Light& light, const ShadingFrame& frame, double error) {
    if (const auto* sphere = std::get_if<SphereLight>(&light)) {
        return view(*sphere, frame).has_value();
    }
    return is_seen(std::get<PolygonLight>(light), frame, error);
}

double least_distance(const Light& light, const Vec3d& position) {
    if (const auto* sphere = std::get_if<SphereLight>(&light)) {
        return std::max(0.0, glm::length(sphere->center - position) - sphere->radius);
    }
    const auto& polygon = std::get<PolygonLight>(light);
    return std::max(std::abs(glm::dot(polygon.normal, position - polygon.center)),
                    glm::length(polygon.center - position) - polygon.radius);
}

Circle circle_of(const CapView& cap) {
    switch (cap.kind) {
        case CapView::Kind::sphere:
            return circle_of_sphere(cap.center, cap.radius);
        case CapView::Kind::facing_disk:
            return circle_of_facing_disk(cap.center, cap.radius);
        case CapView::Kind::inside:
            break;
    }
    return {{0, 0, 1}, 0, 1};
}

}  // namespace shlight
