// SPDX-License-Identifier: MIT
#include "polygons/polygon_region.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shlight {
namespace {

/// An edge's length by its half, from a product that is accurate for short edges and a dot product.
template <class Real>
struct HalfLength {
    Real sine, cosine;

    HalfLength(Real sine_of_whole, Real cosine_of_whole) {
        if (cosine_of_whole >= 0) {
            cosine = std::sqrt((1 + cosine_of_whole) / 2);
            sine = sine_of_whole / (2 * cosine);
        } else {
            sine = std::sqrt((1 - cosine_of_whole) / 2);
            cosine = sine_of_whole / (2 * sine);
        }
    }
};

/// The middle of the edge from a to b, from their sum where that is long, else from their difference.
template <class Real>
Vec3<Real> middle(const Vec3<Real>& a, const Vec3<Real>& b, const Vec3<Real>& pole) {
    return glm::normalize(glm::dot(a, b) >= 0 ? a + b : glm::cross(b - a, pole));
}

/// The circle that has the edge as its diameter meets the edge's own at right angles, and so do their images. In that
/// right triangle tan(angle/2) = tan(half the diameter's image) / sin(half angle of the edge's circle): no arc tangent
/// of differences of end points, which could not tell an arc of no length from the whole circle.
double arc_angle(const Circle& edge, const Circle& diameter) {
    return 2 * std::atan2(diameter.sine, diameter.cosine * edge.sine);
}

}  // namespace

template <class Real>
PolygonRegion<Real>::PolygonRegion(const SphericalPolygon<Real>& polygon, const Warp& warp)
    : solid_angle_(polygon.solid_angle()) {
    const std::vector<Vec3<Real>>& v = polygon.directions();
    arcs_.reserve(v.size());
    for (std::size_t i = 0; i < v.size(); ++i) {
        const Vec3<Real>& a = v[i];
        const Vec3<Real>& b = v[(i + 1) % v.size()];
        const Real sine = glm::length(polygon.edge_cross(i));
        if (!(sine > 0)) {
            continue;
        }
        const Vec3<Real> pole = polygon.edge_cross(i) * (1 / sine);
        if (warp.is_identity()) {
            arcs_.push_back({pole, 0, 1, std::atan2(sine, glm::dot(a, b)), a, b});
            continue;
        }
        const HalfLength<Real> half(sine, glm::dot(a, b));
        const Circle edge = warp.warped(Circle{Vec3d(pole), 0, 1});
        const Circle diameter = warp.warped(
            Circle{Vec3d(middle(a, b, pole)), static_cast<double>(half.cosine), static_cast<double>(half.sine)});
        arcs_.push_back({Vec3<Real>(edge.axis), edge.cosine, edge.sine, arc_angle(edge, diameter),
                         Vec3<Real>(warp.warped(Vec3d(a))), Vec3<Real>(warp.warped(Vec3d(b)))});
        // Gauss–Bonnet before and after: the warp keeps the angles at the corners, so only the arcs' turning differs.
        solid_angle_ -= arcs_.back().cosine * arcs_.back().angle;
    }
    solid_angle_ = std::max(solid_angle_, Real(0));
}

template <class Real>
Real PolygonRegion<Real>::outline() const {
    Real length = 0;
    for (const Arc<Real>& arc : arcs_) {
        length += arc.sine * arc.angle;
    }
    return length;
}

template <class Real>
std::array<Real, 4> PolygonRegion<Real>::low_bands() const {
    Vec3<Real> sum(0);
    for (const Arc<Real>& arc : arcs_) {
        sum += arc.sine * arc.sine * arc.angle * arc.axis;
        sum += arc.cosine * glm::cross(arc.axis, arc.to - arc.from);
    }
    constexpr Real kPi = std::numbers::pi_v<Real>;
    sum *= std::sqrt(3 / (4 * kPi)) / 2;
    return {solid_angle_ * std::sqrt(1 / (4 * kPi)), sum.y, sum.z, sum.x};
}

template class PolygonRegion<double>;
template class PolygonRegion<long double>;

}  // namespace shlight
