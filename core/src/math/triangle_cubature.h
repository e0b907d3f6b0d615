// SPDX-License-Identifier: MIT
//
// Cubature on spherical triangles.
#pragma once

#include <span>

#include "shlight/types.h"

namespace shlight {

/// The point a + first (b - a) + second (c - a) of a triangle. Weights of a rule sum to 1.
struct TrianglePoint {
    double first, second, weight;
};

/// Gauss's product rule of side² points, computed once; exact for polynomials of degree 2 side - 2.
std::span<const TrianglePoint> product_rule(int side);
/// Rules of three points, degree 2, and of seven points, degree 5 (Radon 1948).
std::span<const TrianglePoint> three_point_rule();
std::span<const TrianglePoint> seven_point_rule();

/// Calls visit(direction, weight) for the points of a rule on a small triangle of unit vectors; weights are negative if
/// the winding is opposite. triple: a·(b×c), given because the corners of a narrow triangle determine few of its
/// digits. The triangle is projected onto the plane that touches the sphere at its middle, where the density is smooth
/// even if the light's vertices have very different distances.
template <class Visit>
void visit_triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c, double triple, std::span<const TrianglePoint> rule,
                    const Visit& visit) {
    const Vec3d axis = glm::normalize(a + b + c);
    const double a_along = glm::dot(a, axis);
    const double b_along = glm::dot(b, axis);
    const double c_along = glm::dot(c, axis);
    const Vec3d corner = a / a_along;
    const Vec3d ab = b / b_along - corner;
    const Vec3d ac = c / c_along - corner;
    const double area = triple / (2 * a_along * b_along * c_along);
    for (const TrianglePoint& point : rule) {
        const Vec3d p = corner + point.first * ab + point.second * ac;
        const double length = glm::length(p);
        visit(p / length, point.weight * area / (length * length * length));
    }
}

}  // namespace shlight
