// SPDX-License-Identifier: MIT
#include "polygons/polygon_low_bands.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace shlight {
namespace {

/// Integrals along an edge of the pole N: of u and, symmetric, of the products of u's components.
template <class Real>
struct EdgeMoments {
    Vec3<Real> pole, first;
    Real xx, yy, zz, xy, xz, yz;

    /// With M the edge's middle, T = N×M and h half the length, u = M cosτ + T sinτ for |τ| ≤ h.
    explicit EdgeMoments(const Arc<Real>& arc) : pole(arc.axis) {
        const Vec3<Real> chord = arc.to - arc.from;
        const Vec3<Real> sum = arc.from + arc.to;
        const Vec3<Real> m =
            glm::normalize(glm::dot(arc.from, arc.to) >= 0 ? sum : glm::cross(chord, arc.axis));  // the longer one
        const Vec3<Real> t = glm::cross(pole, m);
        const Real half = arc.angle / 2;
        const Real product = glm::length(chord) * glm::length(sum) / 4;  // sin h cos h
        const Real along = half + product;
        const Real across = half - product;
        first = glm::length(chord) * m;
        xx = along * m.x * m.x + across * t.x * t.x;
        yy = along * m.y * m.y + across * t.y * t.y;
        zz = along * m.z * m.z + across * t.z * t.z;
        xy = along * m.x * m.y + across * t.x * t.y;
        xz = along * m.x * m.z + across * t.x * t.z;
        yz = along * m.y * m.z + across * t.y * t.z;
    }
};

/// Σ over edges of ∫ N·∇p ds for the polynomials p of
///   Y_2 ~ xy, yz, 2z²-x²-y², xz, x²-y²,
///   Y_3 ~ y(3x²-y²), xyz, y(4z²-x²-y²), z(2z²-3x²-3y²), x(4z²-x²-y²), z(x²-y²), x(x²-3y²).
template <class Real>
struct Gradients {
    std::array<Real, 5> second{};
    std::array<Real, 7> third{};

    void add_second(const EdgeMoments<Real>& e) {
        const Vec3<Real>& n = e.pole;
        const Vec3<Real>& v = e.first;
        second[0] += n.x * v.y + n.y * v.x;
        second[1] += n.y * v.z + n.z * v.y;
        second[2] += 4 * n.z * v.z - 2 * (n.x * v.x + n.y * v.y);
        second[3] += n.x * v.z + n.z * v.x;
        second[4] += 2 * (n.x * v.x - n.y * v.y);
    }
    void add_third(const EdgeMoments<Real>& e) {
        const Vec3<Real>& n = e.pole;
        const Real difference = e.xx - e.yy;
        third[0] += 3 * n.y * difference + 6 * n.x * e.xy;
        third[1] += n.x * e.yz + n.y * e.xz + n.z * e.xy;
        third[2] += n.y * (4 * e.zz - e.xx - 3 * e.yy) - 2 * n.x * e.xy + 8 * n.z * e.yz;
        third[3] += n.z * (6 * e.zz - 3 * (e.xx + e.yy)) - 6 * (n.x * e.xz + n.y * e.yz);
        third[4] += n.x * (4 * e.zz - 3 * e.xx - e.yy) - 2 * n.y * e.xy + 8 * n.z * e.xz;
        third[5] += n.z * difference + 2 * (n.x * e.xz - n.y * e.yz);
        third[6] += 3 * n.x * difference - 6 * n.y * e.xy;
    }
};

/// What makes these polynomials orthonormal, with Stokes' 1/(l(l+1)).
template <class Real>
struct Norms {
    std::array<Real, 5> second;
    std::array<Real, 7> third;

    Norms() {
        const auto of = [](int square, int stokes) {
            return std::sqrt(static_cast<Real>(square) / (32 * std::numbers::pi_v<Real>)) / static_cast<Real>(stokes);
        };
        second = {of(120, 6), of(120, 6), of(10, 6), of(120, 6), of(30, 6)};
        third = {of(35, 12), of(840, 12), of(21, 12), of(14, 12), of(21, 12), of(210, 12), of(35, 12)};
    }
    static const Norms& get() {
        static const Norms norms;
        return norms;
    }
};

}  // namespace

template <class T>
void low_band_coefficients(const PolygonRegion<Wider<T>>& region, int order, T* coefficients) {
    using Real = Wider<T>;
    const auto low = region.low_bands();
    std::transform(low.begin(), low.begin() + std::min(4, coefficient_count(order)), coefficients,
                   [](Real c) { return static_cast<T>(c); });
    if (order <= 2) {
        return;
    }
    Gradients<Real> gradients;
    for (const Arc<Real>& arc : region.arcs()) {
        const EdgeMoments<Real> edge(arc);
        gradients.add_second(edge);
        if (order > 3) {
            gradients.add_third(edge);
        }
    }
    const auto scaled = [](Real gradient, Real norm) { return static_cast<T>(gradient * norm); };
    const Norms<Real>& norms = Norms<Real>::get();
    std::transform(gradients.second.begin(), gradients.second.end(), norms.second.begin(), coefficients + 4, scaled);
    if (order > 3) {
        std::transform(gradients.third.begin(), gradients.third.end(), norms.third.begin(), coefficients + 9, scaled);
    }
}

template void low_band_coefficients(const PolygonRegion<double>&, int, float*);
template void low_band_coefficients(const PolygonRegion<long double>&, int, double*);

}  // namespace shlight
