// SPDX-License-Identifier: MIT
//
// Planes near the shading point, through it, and nearly so.
#pragma once

#include <array>
#include <cmath>

#include "input.h"

namespace shlight::fuzzing {

struct Plane {
    Vec3d center, u, v;

    explicit Plane(Input& input) {
        const Vec3d normal = input.direction();
        const Vec3d aside = std::abs(normal.x) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
        u = glm::normalize(glm::cross(aside, normal));
        v = glm::cross(normal, u);
        // Far, near, around the shading point, edge-on, or with an edge or a corner near it.
        const double away = input.small(4), touch = input.small(16);
        const std::array<Vec3d, 5> centers = {normal / away, away * normal, touch * normal, touch * normal + u / away,
                                              touch * normal + u * input.uniform(-2, 2) + v * input.uniform(-2, 2)};
        center = input.one_of(centers);
    }

    Vec3d point(double a, double b) const { return center + a * u + b * v; }
    double distance() const { return std::abs(glm::dot(center, glm::cross(u, v))); }
};

}  // namespace shlight::fuzzing
