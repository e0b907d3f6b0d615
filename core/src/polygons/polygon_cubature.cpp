// SPDX-License-Identifier: MIT
#include "polygons/polygon_cubature.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "math/gauss_legendre.h"
#include "math/triangle_cubature.h"
#include "shlight/basis.h"

namespace shlight {
namespace {

/// Triangles longer than this are halved first: beyond it the density of the projection costs more points than it
/// saves.
constexpr double kLongestSide = 0.7;

template <class Real>
struct ProjectedTriangle {
    Vec3<Real> a, b, c;
};

/// Points a side that integrate order-n harmonics over a triangle of this longest side to the precision of T:
/// a wave of κ = n·side/2 radians needs about κ/2 points before convergence sets in, then a few for the digits.
template <class T>
int points_per_side(int order, double side) {
    const double kappa = 0.5 * order * side;
    const double points = std::is_same_v<T, float> ? 2.5 + 0.9 * kappa + 6 * side : 5 + 1.1 * kappa + 16 * side;
    return std::clamp(static_cast<int>(std::ceil(points)), 2, kMaxGaussPoints);
}

/// Adds the integral over a small triangle. Returns the sum of the weights.
template <class T>
Wider<T> add_small_triangle(const ProjectedTriangle<Wider<T>>& t, Wider<T> side, int order, T* coefficients) {
    using Real = Wider<T>;
    const int count = coefficient_count(order);
    std::array<T, static_cast<std::size_t>(coefficient_count(kMaxOrder))> basis;
    const auto rule = product_rule(points_per_side<T>(order, static_cast<double>(side)));
    return visit_triangle(t.a, t.b, t.c, rule, [&](const Vec3<Real>& direction, Real weight) {
        sh_basis(Vec3<T>(direction), order, basis.data());
        for (int k = 0; k < count; ++k) {
            coefficients[k] += static_cast<T>(weight) * basis[k];
        }
    });
}

template <class T>
Wider<T> add_triangle(const ProjectedTriangle<Wider<T>>& t, int order, T* coefficients) {
    using Real = Wider<T>;
    const std::array<Real, 3> sides = {glm::length(t.b - t.a), glm::length(t.c - t.b), glm::length(t.a - t.c)};
    const Real longest = *std::max_element(sides.begin(), sides.end());
    if (longest <= kLongestSide) {
        return add_small_triangle<T>(t, longest, order, coefficients);
    }
    using Turned = ProjectedTriangle<Real>;
    const Turned turned = longest == sides[0] ? t : longest == sides[1] ? Turned{t.b, t.c, t.a} : Turned{t.c, t.a, t.b};
    const Vec3<Real> middle = glm::normalize(turned.a + turned.b);
    return add_triangle<T>(Turned{turned.a, middle, turned.c}, order, coefficients) +
           add_triangle<T>(Turned{middle, turned.b, turned.c}, order, coefficients);
}

}  // namespace

template <class T>
void polygon_by_cubature(const SphericalPolygon<Wider<T>>& polygon, int order, T* coefficients) {
    using Real = Wider<T>;
    std::fill_n(coefficients, coefficient_count(order), T(0));
    const std::vector<Vec3<Real>>& v = polygon.directions();
    Real total = 0;
    for (std::size_t i = 1; i + 1 < v.size(); ++i) {
        total += add_triangle<T>(ProjectedTriangle<Real>{v[0], v[i], v[i + 1]}, order, coefficients);
    }
    // The area of a tiny or thin polygon drowns in the rounding of unit vectors; its solid angle was measured before
    // that.
    const auto correction = static_cast<T>(total > 0 ? polygon.solid_angle() / total : 0);
    std::for_each_n(coefficients, coefficient_count(order), [correction](T& c) { c *= correction; });
}

template void polygon_by_cubature(const SphericalPolygon<double>&, int, float*);
template void polygon_by_cubature(const SphericalPolygon<long double>&, int, double*);

}  // namespace shlight
