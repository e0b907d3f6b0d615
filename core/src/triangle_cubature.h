// SPDX-License-Identifier: MIT
//
// Gauss cubature on spherical triangles.
#pragma once

#include "gauss_legendre.h"
#include "shlight/types.h"

namespace shlight {

/// Calls visit(direction, weight) for the points of a product rule on a small triangle of unit vectors, and returns the
/// sum of the weights, negative for a triangle of the other winding. The triangle is projected onto the plane that
/// touches the sphere at its middle, where the density is smooth however unevenly far away the light's own vertices
/// are.
template <class Real, class Visit>
Real visit_triangle(const Vec3<Real>& first, const Vec3<Real>& second, const Vec3<Real>& third, const GaussRule& rule,
                    const Visit& visit) {
    const Vec3<Real> axis = glm::normalize(first + second + third);
    const Vec3<Real> a = first / glm::dot(first, axis);
    const Vec3<Real> ab = second / glm::dot(second, axis) - a;
    const Vec3<Real> ac = third / glm::dot(third, axis) - a;
    const Real area = glm::dot(axis, glm::cross(ab, ac));
    Real total = 0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const Real u = rule.nodes[i];
        for (std::size_t j = 0; j < rule.nodes.size(); ++j) {
            const Real v = rule.nodes[j];
            const Vec3<Real> p = a + u * ((1 - v) * ab + v * ac);
            const Real length = glm::length(p);
            const Real weight = Real(rule.weights[i]) * rule.weights[j] * u * area / (length * length * length);
            total += weight;
            visit(p / length, weight);
        }
    }
    return total;
}

}  // namespace shlight
