// SPDX-License-Identifier: MIT
#include "surfaces/visible_lamps.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "surfaces/lamp_drawer.h"

namespace shlight {
namespace {

/// The part of a ray where lamps are visible.
struct View {
    Vec3d start;
    Vec3d direction;  // unit
    double length;
    bool reaches_suns;

    bool covers(double distance) const { return distance > 0 && distance < length; }
};

bool meets_sphere(const SphereLight& light, const View& view) {
    const Vec3d to_center = light.center - view.start;
    const double along = glm::dot(to_center, view.direction);
    const Vec3d across = to_center - along * view.direction;
    const double half_chord_squared = light.radius * light.radius - glm::dot(across, across);
    if (half_chord_squared < 0) {
        return false;
    }
    const bool inside = glm::dot(to_center, to_center) < light.radius * light.radius;
    return view.covers(along - std::copysign(std::sqrt(half_chord_squared), inside ? -1.0 : 1.0));
}

/// The disk is perpendicular to the line to the ray's start.
bool meets_disk(const SphereLight& light, const View& view) {
    const Vec3d to_center = light.center - view.start;
    const double along = glm::dot(to_center, view.direction);
    if (along <= 0) {
        return false;
    }
    const double distance = glm::dot(to_center, to_center) / along;
    return view.covers(distance) && glm::length(distance * view.direction - to_center) <= light.radius;
}

bool meets(const SphereLight& light, const View& view) {
    return light.facing_disk ? meets_disk(light, view) : meets_sphere(light, view);
}

/// Distance at which a ray meets the light's plane from an emitting side; 0 if it does not.
template <class PlanarLight>
double distance_to_plane(const PlanarLight& light, const Vec3d& in_plane, const View& view) {
    const double approach = -glm::dot(view.direction, light.normal);
    if (approach == 0 || (approach < 0 && !light.two_sided)) {
        return 0;
    }
    return glm::dot(view.start - in_plane, light.normal) / approach;
}

bool meets(const PolygonLight& light, const View& view) {
    const double distance = distance_to_plane(light, light.vertices[0], view);
    if (!view.covers(distance)) {
        return false;
    }
    const Vec3d point = view.start + distance * view.direction;
    const auto left_of = [&](std::uint32_t from, std::uint32_t to) {
        const Vec3d& a = light.vertices[from];
        return glm::dot(light.normal, glm::cross(light.vertices[to] - a, point - a)) >= 0;
    };
    return std::any_of(light.triangles.begin(), light.triangles.end(),
                       [&](const Triangle& t) { return left_of(t.x, t.y) && left_of(t.y, t.z) && left_of(t.z, t.x); });
}

bool meets(const DiskLight& light, const View& view) {
    const double distance = distance_to_plane(light, light.center, view);
    if (!view.covers(distance)) {
        return false;
    }
    const Vec3d way = view.start + distance * view.direction - light.center;
    const double area = glm::dot(glm::cross(light.half_axis_u, light.half_axis_v), light.normal);
    const double a = glm::dot(glm::cross(way, light.half_axis_v), light.normal);
    const double b = glm::dot(glm::cross(light.half_axis_u, way), light.normal);
    return std::hypot(a, b) <= area;
}

bool meets(const SunLight& light, const View& view) {
    // Compared by chords, because cosines of small angles lose digits.
    return view.reaches_suns && glm::length(view.direction - light.direction) <= 2 * std::sin(light.half_angle / 2);
}

bool meets(const MeshLight&, const View&) {
    return false;
}

bool meets(const PointSource&, const View&) {
    return false;
}

bool meets(const ParallelSource&, const View&) {
    return false;
}

}  // namespace

VisibleLamps::VisibleLamps(std::span<const Light> lights, LampViewer viewer) {
    for (const Light& light : lights) {
        const LightTraits& traits = traits_of(light);
        const bool in_mirrors = traits.lights_glossy && traits.casts_shadows == (viewer == LampViewer::mirror);
        const bool seen = viewer == LampViewer::camera ? traits.seen_by_camera : in_mirrors;
        if (seen && !traits.is_surface && !is_delta(light)) {
            lamps_.push_back(&light);
        }
    }
}

Rgb VisibleLamps::radiance(const Ray& ray, const std::optional<double>& surface,
                           const std::optional<std::uint32_t>& light_set, std::span<Rgb> by_group,
                           double density) const {
    const Vec3d direction = glm::normalize(Vec3d(ray.direction));
    const double end = std::min<double>(ray.t_max, surface.value_or(ray.t_max));
    const View view = {Vec3d(ray.origin) + double{ray.t_min} * direction, direction, end - ray.t_min, !surface};
    Rgb sum(0);
    for (const Light* lamp : lamps_) {
        const bool shows = !light_set || traits_of(*lamp).links.lights(*light_set);
        if (shows && std::visit([&](const auto& light) { return meets(light, view); }, *lamp)) {
            const double left = std::isinf(density) ? 1.0 : 1 - drawn_part(*lamp, Vec3d(ray.origin), density);
            const Rgb radiance =
                strength_of(*lamp) * static_cast<float>(left * profile_factor(traits_of(*lamp).profile, -direction));
            sum += radiance;
            if (!by_group.empty()) {
                by_group[traits_of(*lamp).group] += radiance;
            }
        }
    }
    return sum;
}

}  // namespace shlight
