// SPDX-License-Identifier: MIT
//
// Cubature on spherical triangles.
#pragma once

#include <span>

#include "shlight/types.h"

namespace shlight {

/// A point a + first (b - a) + second (c - a) of a triangle; the weights of a rule sum to 1.
struct TrianglePoint {
    double first, second, weight;
};

/// Gauss's product rule of side² points, computed once; exact for polynomials of degree 2 side - 2.
std::span<const TrianglePoint> product_rule(int side);
/// Rules of three points, degree 2, and of seven points, degree 5 (Radon 1948).
std::span<const TrianglePoint> three_point_rule();
std::span<const TrianglePoint> seven_point_rule();

/// Calls visit(direction, weight) for the points of a rule on a small triangle of unit vectors, and returns the sum of
/// the weights, negative for a triangle of the other winding. The triangle is projected onto the plane that touches the
/// sphere at its middle, where the density is smooth however unevenly far away the light's own vertices are.
template <class Real, class Visit>
Real visit_triangle(const Vec3<Real>& first, const Vec3<Real>& second, const Vec3<Real>& third,
                    std::span<const TrianglePoint> rule, const Visit& visit) {
    const Vec3<Real> axis = glm::normalize(first + second + third);
    const Vec3<Real> a = first / glm::dot(first, axis);
    const Vec3<Real> ab = second / glm::dot(second, axis) - a;
    const Vec3<Real> ac = third / glm::dot(third, axis) - a;
    const Real area = glm::dot(axis, glm::cross(ab, ac)) / 2;
    Real total = 0;
    for (const TrianglePoint& point : rule) {
        const Vec3<Real> p = a + Real(point.first) * ab + Real(point.second) * ac;
        const Real length = glm::length(p);
        const Real weight = Real(point.weight) * area / (length * length * length);
        total += weight;
        visit(p / length, weight);
    }
    return total;
}

}  // namespace shlight
