// SPDX-License-Identifier: MIT
#include "surfaces/round_places.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

namespace shlight {

Vec3d normalized_or(const Vec3d& v, const Vec3d& fallback) {
    const double length = glm::length(v);
    return length > 0 && std::isfinite(length) ? v / length : fallback;
}

RoundPlace round_place(const MeshShape& shape, std::span<const Vec3f> vertices, double radius_scale,
                       const RayHit& hit) {
    const auto at = [&](std::size_t i) { return glm::dvec4(vertices[i], radius_scale * double{shape.radii[i]}); };
    const std::size_t vertex = hit.triangle;
    if (!shape.is_curved()) {
        return {shape.form, Vec3d(at(vertex)), Vec3d(0), at(vertex).w};
    }
    const std::size_t curve = shape.part(hit.triangle);
    const std::array<glm::dvec4, 4> p = {at(std::max<std::size_t>(vertex, shape.first[curve] + 1) - 1), at(vertex),
                                         at(vertex + 1), at(std::min(vertex + 2, shape.curve_end(curve) - 1))};
    // The cubic from p[1] to p[2] whose derivatives there are half of what lies between the neighbours.
    const glm::dvec4 start = (p[2] - p[0]) / 2.0;
    const glm::dvec4 end = (p[3] - p[1]) / 2.0;
    const glm::dvec4 square = 3.0 * (p[2] - p[1]) - 2.0 * start - end;
    const glm::dvec4 cube = 2.0 * (p[1] - p[2]) + start + end;
    const double u = hit.u;
    const glm::dvec4 place = p[1] + u * (start + u * (square + u * cube));
    return {shape.form, Vec3d(place), Vec3d(start + u * (2.0 * square + 3.0 * u * cube)), std::max(place.w, 0.0)};
}

OutwardNormal outward_normal(const RoundPlace& place, const RayHit& hit, const Vec3d& direction) {
    const Vec3d towards_viewer = normalized_or(-direction, Vec3d(0, 0, 1));
    const Vec3d along = normalized_or(place.along, Vec3d(0));
    if (place.form != SurfaceForm::ribbons) {
        const Vec3d own = normalized_or(Vec3d(hit.normal), towards_viewer);
        return {normalized_or(own - glm::dot(own, along) * along, own)};
    }
    const Vec3d across = normalized_or(glm::cross(along, towards_viewer), Vec3d(0));
    if (across == Vec3d(0)) {
        return {towards_viewer, towards_viewer};
    }
    const double sine = std::clamp(double{hit.v}, -1.0, 1.0);
    const Vec3d lift = std::sqrt(1 - sine * sine) * glm::cross(across, along);
    return {sine * across + lift, lift};
}

}  // namespace shlight
