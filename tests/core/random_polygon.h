// SPDX-License-Identifier: MIT
//
// Random polygons: the plain ones and all kinds that tempt rounding.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "random_input.h"
#include "shlight/types.h"

namespace shlight::testing {

using Vertices = std::vector<Vec3d>;

/// One kind of polygons.
struct PolygonClass {
    const char* name;
    Vertices (*draw)(RandomInput&);
};

/// A plane's two axes, orthonormal; their cross product is `normal`.
struct Plane {
    Vec3d u, v;

    Plane(RandomInput& random, const Vec3d& normal)
        : u(glm::normalize(glm::cross(random.direction(), normal))), v(glm::cross(glm::normalize(normal), u)) {}
};

/// Star-shaped about `center`: radii between `inner` and 1 times the two half sizes.
inline Vertices star(RandomInput& random, const Vec3d& center, const Plane& plane, int count, double inner,
                     double half_u, double half_v) {
    Vertices vertices;
    for (int i = 0; i < count; ++i) {
        const double angle = 2 * std::numbers::pi * (i + random.uniform(0, 0.7)) / count;
        const double radius = inner < 0.4 && i % 2 == 1 ? inner : random.uniform(std::max(inner, 0.6), 1);
        vertices.push_back(center + radius * (half_u * std::cos(angle) * plane.u + half_v * std::sin(angle) * plane.v));
    }
    return vertices;
}

/// A unit vector above the horizon or a little below.
inline Vec3d seen_direction(RandomInput& random) {
    return random.at_tilt(random.uniform(0, 1.7));
}

/// Position, plane and half size of a plane figure.
struct Place {
    Vec3d center;
    Plane plane;
    double half;
};

/// Somewhere in front, turned by up to about 80° away, of the given size relative to its distance.
inline Place facing_place(RandomInput& random, double size) {
    const Vec3d center = random.log_uniform(0.01, 100) * seen_direction(random);
    const Vec3d normal = glm::normalize(center) + 0.98 * random.direction();
    return {center, Plane(random, normal), size * glm::length(center)};
}

/// All but touching the shading point, which sees the figure as nearly half the sphere.
inline Place place_near_contact(RandomInput& random) {
    const Vec3d normal = seen_direction(random);
    const Plane plane(random, normal);
    const double size = random.log_uniform(0.1, 10);
    const Vec3d center = size * (random.log_uniform(1e-6, 1e-2) * normal + random.uniform(-0.3, 0.3) * plane.u +
                                 random.uniform(-0.3, 0.3) * plane.v);
    return {center, plane, size};
}

/// A plane that all but passes through the shading point, beside the figure.
inline Place place_nearly_edge_on(RandomInput& random) {
    const Vec3d center = seen_direction(random);
    const Vec3d aside = glm::normalize(glm::cross(center, random.direction()));
    const double size = random.log_uniform(0.1, 0.8);
    return {center, Plane(random, aside + random.log_uniform(1e-6, 1e-2) * center), size};
}

inline Vertices facing(RandomInput& random, int count, double inner, double size) {
    const Place place = facing_place(random, size);
    return star(random, place.center, place.plane, count, inner, place.half, place.half);
}

inline Vertices plain(RandomInput& random) {
    return facing(random, random.integer(3, 5), 0.6, random.log_uniform(0.01, 1));
}
inline Vertices concave(RandomInput& random) {
    return facing(random, random.integer(3, 5) * 2, random.uniform(0.15, 0.4), random.log_uniform(0.01, 1));
}
inline Vertices small(RandomInput& random) {
    return facing(random, random.integer(3, 5), 0.6, random.log_uniform(1e-3, 0.03));
}
inline Vertices tiny(RandomInput& random) {
    return facing(random, 3, 0.6, random.log_uniform(1e-6, 1e-3));
}
inline Vertices large(RandomInput& random) {
    return facing(random, random.integer(3, 5), 0.6, random.log_uniform(1, 30));
}

inline Vertices near_contact(RandomInput& random) {
    const Place place = place_near_contact(random);
    return star(random, place.center, place.plane, random.integer(3, 5), 0.6, place.half, place.half);
}

/// One edge all but touches the shading point, which sees it as half a turn.
inline Vertices contact_at_an_edge(RandomInput& random) {
    const Vec3d along = random.chance(0.5) ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
    const Vec3d across = as_float(glm::cross(random.at_tilt(random.uniform(0.2, 1.3)), along));
    const Vec3d above = random.log_uniform(1e-12, 1e-3) * glm::normalize(glm::cross(along, across));
    const double reach = random.uniform(0.3, 1);
    return {above - reach * along, above + along, above + along + across, above - reach * along + across};
}

/// Long and thin: the width is 1e-6 … 1e-2 of the length.
inline Vertices thin(RandomInput& random) {
    const Vec3d center = random.log_uniform(0.3, 3) * seen_direction(random);
    const double width = random.log_uniform(1e-6, 1e-2);
    return star(random, center, Plane(random, center + 0.5 * random.direction()), random.integer(3, 4), 0.6, 1, width);
}

inline Vertices nearly_edge_on(RandomInput& random) {
    const Place place = place_nearly_edge_on(random);
    return star(random, place.center, place.plane, random.integer(3, 5), 0.6, place.half, place.half);
}

/// A wall that stands on the horizon's plane, with one edge in it.
inline Vertices on_horizon(RandomInput& random) {
    const Vec3d foot = random.log_uniform(0.3, 10) * random.at_tilt(std::numbers::pi / 2);
    const Vec3d end = foot + random.log_uniform(0.03, 3) * random.at_tilt(std::numbers::pi / 2);
    const Vec3d lean = random.uniform(-0.3, 0.3) * foot;
    const double height = random.log_uniform(0.01, 3);
    Vertices vertices = {foot, end, end + height * Vec3d(lean.x, lean.y, 1), foot + height * Vec3d(lean.x, lean.y, 1)};
    vertices[0].z = vertices[1].z = 0;
    if (random.chance(0.3)) {
        vertices.pop_back();
    }
    return vertices;
}

/// Vertices a thousand times farther away than their neighbours.
inline Vertices deep(RandomInput& random) {
    const Vec3d normal = seen_direction(random);
    const Plane plane(random, normal);
    const double angle = random.uniform(0, 2 * std::numbers::pi);
    const Vec3d away = std::cos(angle) * plane.u + std::sin(angle) * plane.v;
    const Vec3d side = glm::cross(normal, away);
    const Vec3d start = normal + random.uniform(-1, 1) * away;
    const double far = random.log_uniform(100, 1000);
    const double width = random.log_uniform(0.1, 1);
    if (random.chance(0.5)) {
        return {start - width * side, start + width * side, start + far * away};
    }
    return {start - width * side, start + width * side, start + far * (away + 0.3 * side), start + far * away};
}

}  // namespace shlight::testing
