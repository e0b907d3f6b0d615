// SPDX-License-Identifier: MIT
//
// Random disks and ellipses: the plain ones and all kinds that tempt rounding.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "quad_ellipse.h"
#include "random_polygon.h"

namespace shlight::testing {

using truth::EllipseInput;

/// One kind of disks.
struct EllipseClass {
    const char* name;
    EllipseInput (*draw)(RandomInput&);
};

/// Half axes of these lengths in a plane, replaced by a random conjugate pair of the same ellipse.
inline EllipseInput conjugate(RandomInput& random, const Vec3d& center, const Plane& plane, double half_u,
                              double half_v) {
    const double t = random.uniform(0, 2 * std::numbers::pi);
    const Vec3d u = half_u * plane.u;
    const Vec3d v = half_v * plane.v;
    return {center, std::cos(t) * u + std::sin(t) * v,
            (random.chance(0.5) ? 1.0 : -1.0) * (std::cos(t) * v - std::sin(t) * u)};
}

inline EllipseInput facing_ellipse(RandomInput& random, double size, double flatness) {
    const Place place = facing_place(random, size);
    return conjugate(random, place.center, place.plane, place.half, flatness * place.half);
}

inline EllipseInput plain_disk(RandomInput& random) {
    return facing_ellipse(random, random.log_uniform(0.01, 1), 1);
}
inline EllipseInput plain_ellipse(RandomInput& random) {
    return facing_ellipse(random, random.log_uniform(0.01, 1), random.log_uniform(0.1, 1));
}
inline EllipseInput small_disk(RandomInput& random) {
    return facing_ellipse(random, random.log_uniform(1e-3, 0.03), random.log_uniform(0.3, 1));
}
inline EllipseInput tiny_disk(RandomInput& random) {
    return facing_ellipse(random, random.log_uniform(1e-6, 1e-3), random.log_uniform(0.3, 1));
}
inline EllipseInput large_disk(RandomInput& random) {
    return facing_ellipse(random, random.log_uniform(1, 30), random.log_uniform(0.2, 1));
}

inline EllipseInput disk_near_contact(RandomInput& random) {
    const Place place = place_near_contact(random);
    return conjugate(random, place.center, place.plane, place.half, random.uniform(0.5, 1) * place.half);
}

/// At right angles to the way to it: a cap.
inline EllipseInput disk_that_faces(RandomInput& random) {
    const Vec3d center = as_float(random.log_uniform(0.01, 100) * seen_direction(random));
    const double radius = glm::length(center) * random.log_uniform(1e-3, 100);
    return conjugate(random, center, Plane(random, center), radius, radius);
}

/// A point of the rim all but touches the shading point, from inside or outside.
inline EllipseInput rim_near_contact(RandomInput& random) {
    const Vec3d normal = seen_direction(random);
    const Plane plane(random, normal);
    const double flat = random.log_uniform(0.1, 1);
    const double t = random.uniform(0, 2 * std::numbers::pi);
    const Vec3d rim = std::cos(t) * plane.u + flat * std::sin(t) * plane.v;
    const double away = random.log_uniform(1e-6, 1e-2);
    const Vec3d center = away * normal - (1 + (random.chance(0.5) ? 1 : -1) * random.log_uniform(1e-6, 1e-2)) * rim;
    return conjugate(random, center, plane, 1, flat);
}

/// Long and thin: the width is 1e-6 … 1e-2 of the length.
inline EllipseInput thin_ellipse(RandomInput& random) {
    const Vec3d center = random.log_uniform(0.3, 3) * seen_direction(random);
    const Plane plane(random, center + 0.5 * random.direction());
    return conjugate(random, center, plane, 1, random.log_uniform(1e-6, 1e-2));
}

inline EllipseInput disk_nearly_edge_on(RandomInput& random) {
    const Place place = place_nearly_edge_on(random);
    return conjugate(random, place.center, place.plane, place.half, random.uniform(0.3, 1) * place.half);
}

/// Turned about the direction to it until its lowest or highest point is at the horizon but for `share` of its height.
inline EllipseInput moved_to_horizon(EllipseInput disk, double share) {
    const double rise = std::hypot(disk.half_axis_u.z, disk.half_axis_v.z);
    disk.center.z = share * rise;
    return disk;
}
/// All but a sliver below the horizon.
inline EllipseInput sliver_of_disk(RandomInput& random) {
    return moved_to_horizon(random.chance(0.5) ? plain_ellipse(random) : large_disk(random),
                            random.log_uniform(1e-6, 1e-2) - 1);
}
/// Touching the horizon, just cut or just not.
inline EllipseInput tangent_disk(RandomInput& random) {
    const double off = random.log_uniform(1e-12, 1e-4);
    return moved_to_horizon(plain_ellipse(random), random.chance(0.3) ? 1 : random.chance(0.5) ? 1 + off : 1 - off);
}
/// Cut through the middle.
inline EllipseInput cut_disk(RandomInput& random) {
    return moved_to_horizon(facing_ellipse(random, random.log_uniform(1e-4, 30), random.log_uniform(0.03, 1)),
                            random.uniform(-0.95, 0.95));
}
/// Thin or nearly edge-on, cut.
inline EllipseInput cut_strip(RandomInput& random) {
    return moved_to_horizon(random.chance(0.5) ? thin_ellipse(random) : disk_nearly_edge_on(random),
                            random.uniform(-0.99, 0.99));
}
/// A great ellipse near the shading point, of which the horizon leaves a lune.
inline EllipseInput lune(RandomInput& random) {
    const Vec3d normal = random.at_tilt(std::numbers::pi - random.log_uniform(1e-4, 1));
    const Plane plane(random, normal);
    const Vec3d center = random.log_uniform(1e-6, 0.3) * normal +
                         random.uniform(0, 0.5) * (random.uniform(-1, 1) * plane.u + random.uniform(-1, 1) * plane.v);
    return conjugate(random, center, plane, 1, random.uniform(0.8, 1));
}

/// All vectors along axes or diagonals, where angles are multiples of a quarter turn.
inline EllipseInput whole_numbers(RandomInput& random) {
    const auto draw = [&](int most) {
        return Vec3d(random.integer(-most, most), random.integer(-most, most), random.integer(-most, most));
    };
    EllipseInput disk{};
    do {
        disk = {draw(2), draw(1), draw(1)};
    } while (glm::dot(disk.center, glm::cross(disk.half_axis_u, disk.half_axis_v)) == 0);
    return disk;
}
/// A great one that all but touches the shading point from below, of which the horizon leaves a lune.
inline EllipseInput lune_in_contact(RandomInput& random) {
    const Plane plane(random, random.at_tilt(std::numbers::pi - random.log_uniform(1e-4, 1)));
    const Vec3d normal = glm::cross(plane.u, plane.v);
    const Vec3d aside = random.uniform(-0.4, 0.4) * plane.u + random.uniform(-0.4, 0.4) * plane.v;
    return conjugate(random, random.log_uniform(1e-12, 1e-6) * normal + aside, plane, 1, random.uniform(0.8, 1));
}

constexpr auto kEllipseClasses = std::to_array<EllipseClass>({
    {"disk", plain_disk},
    {"facing disk", disk_that_faces},
    {"ellipse", plain_ellipse},
    {"small", small_disk},
    {"tiny", tiny_disk},
    {"large", large_disk},
    {"near contact", disk_near_contact},
    {"rim near contact", rim_near_contact},
    {"thin", thin_ellipse},
    {"nearly edge-on", disk_nearly_edge_on},
    {"sliver", sliver_of_disk},
    {"tangent", tangent_disk},
    {"cut", cut_disk},
    {"cut strip", cut_strip},
    {"lune", lune},
    {"lune in contact", lune_in_contact},
    {"whole numbers", whole_numbers},
});

}  // namespace shlight::testing
