// SPDX-License-Identifier: MIT
#include "polygon_cubature.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "gauss_legendre.h"
#include "shlight/basis.h"

namespace shlight {
namespace {

/// Triangles longer than this are halved first: beyond it the density of the projection costs more points than it saves.
constexpr double kLongestSide = 0.7;

struct Triangle {
    Vec3d a, b, c;
};

/// Points a side that integrate order-n harmonics over a triangle of this longest side to the precision of T:
/// a wave of κ = n·side/2 radians needs about κ/2 points before convergence sets in, then a few for the digits.
template <class T>
int points_per_side(int order, double side) {
    const double kappa = 0.5 * order * side;
    const double points = std::is_same_v<T, float> ? 2.5 + 0.9 * kappa + 6 * side : 5 + 1.1 * kappa + 16 * side;
    return std::clamp(static_cast<int>(std::ceil(points)), 2, kMaxGaussPoints);
}

/// Adds the integral over a small triangle. It is projected onto the plane that touches the sphere at its middle, where
/// the density is smooth however unevenly far away the polygon's own vertices are.
/// Returns the sum of the weights.
template <class T>
double add_small_triangle(const Triangle& t, double side, int order, T* coefficients) {
    const Vec3d axis = glm::normalize(t.a + t.b + t.c);
    const Vec3d a = t.a / glm::dot(t.a, axis);
    const Vec3d ab = t.b / glm::dot(t.b, axis) - a;
    const Vec3d ac = t.c / glm::dot(t.c, axis) - a;
    const double area = glm::dot(axis, glm::cross(ab, ac));
    const int count = coefficient_count(order);
    const GaussRule& rule = gauss_rule(points_per_side<T>(order, side));
    std::array<T, static_cast<std::size_t>(coefficient_count(kMaxOrder))> basis;
    double total = 0;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const double u = rule.nodes[i];
        for (std::size_t j = 0; j < rule.nodes.size(); ++j) {
            const Vec3d p = a + u * ((1 - rule.nodes[j]) * ab + rule.nodes[j] * ac);
            const double length = glm::length(p);
            const double weight = rule.weights[i] * rule.weights[j] * u * area / (length * length * length);
            total += weight;
            sh_basis(Vec3<T>(p / length), order, basis.data());
            for (int k = 0; k < count; ++k) {
                coefficients[k] += static_cast<T>(weight) * basis[static_cast<std::size_t>(k)];
            }
        }
    }
    return total;
}

template <class T>
double add_triangle(const Triangle& t, int order, T* coefficients) {
    const std::array<double, 3> sides = {glm::length(t.b - t.a), glm::length(t.c - t.b), glm::length(t.a - t.c)};
    const double longest = *std::max_element(sides.begin(), sides.end());
    if (longest <= kLongestSide) {
        return add_small_triangle(t, longest, order, coefficients);
    }
    const Triangle turned = longest == sides[0] ? t : longest == sides[1] ? Triangle{t.b, t.c, t.a} : Triangle{t.c, t.a, t.b};
    const Vec3d middle = glm::normalize(turned.a + turned.b);
    return add_triangle(Triangle{turned.a, middle, turned.c}, order, coefficients) +
           add_triangle(Triangle{middle, turned.b, turned.c}, order, coefficients);
}

}  // namespace

template <class T>
void polygon_by_cubature(const SphericalPolygon& polygon, int order, T* coefficients) {
    std::fill_n(coefficients, coefficient_count(order), T(0));
    const std::vector<Vec3d>& v = polygon.directions();
    double total = 0;
    for (std::size_t i = 1; i + 1 < v.size(); ++i) {
        total += add_triangle(Triangle{v[0], v[i], v[i + 1]}, order, coefficients);
    }
    // The area of a tiny or thin polygon drowns in the rounding of unit vectors; its solid angle was measured before that.
    const auto correction = static_cast<T>(total > 0 ? polygon.solid_angle() / total : 0);
    std::for_each_n(coefficients, coefficient_count(order), [correction](T& c) { c *= correction; });
}

template void polygon_by_cubature(const SphericalPolygon&, int, float*);
template void polygon_by_cubature(const SphericalPolygon&, int, double*);

}  // namespace shlight
