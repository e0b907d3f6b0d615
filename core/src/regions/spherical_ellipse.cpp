// SPDX-License-Identifier: MIT
#include "regions/spherical_ellipse.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace shlight {
namespace {

/// The directions to an ellipse are c + u cos τ + v sin τ, and (1, cos τ, sin τ) has length zero in the metric (+, -,
/// -). Any turn or boost of the three columns is another parametrisation of the same boundary. Jacobi's rotations,
/// hyperbolic ones for pairs with the first column, make the columns orthogonal: the principal axes of the cone.
template <class Real>
class ColumnRotations {
  public:
    explicit ColumnRotations(const Ellipse<Real>& ellipse)
        : c_(ellipse.center), u_(ellipse.half_axis_u), v_(ellipse.half_axis_v) {
        constexpr int kMostSweeps = 30;
        // They converge quadratically: one more sweep makes roots of roundings roundings.
        bool last = false;
        for (int sweep = 0; sweep < kMostSweeps && !last; ++sweep) {
            last = nearly_orthogonal();
            turn(u_, v_);
            boost(c_, u_);
            boost(c_, v_);
        }
    }

    Ellipse<Real> columns() const { return {c_, u_, v_}; }

  private:
    static bool small(const Vec3<Real>& a, const Vec3<Real>& b) {
        constexpr Real kSquare = std::numeric_limits<Real>::epsilon() / 64;
        const Real product = glm::dot(a, b);
        return product * product <= kSquare * glm::dot(a, a) * glm::dot(b, b);
    }
    bool nearly_orthogonal() const { return small(u_, v_) && small(c_, u_) && small(c_, v_); }

    /// tan 2φ = 2 a·b / (a² - b²), the smaller of both φ.
    static void turn(Vec3<Real>& a, Vec3<Real>& b) {
        const Real twice = 2 * glm::dot(a, b);
        if (twice == 0) {
            return;
        }
        const Real difference = glm::dot(a, a) - glm::dot(b, b);
        const Real root = std::sqrt(difference * difference + twice * twice);
        const Real tangent = twice / (difference < 0 ? difference - root : difference + root);
        const Real c = 1 / std::sqrt(1 + tangent * tangent);
        const Real s = tangent * c;
        const Vec3<Real> turned = c * a + s * b;
        b = c * b - s * a;
        a = turned;
    }

    /// tanh 2η = -2 a·b / (a² + b²). Its distance to ±1 is formed from a + b and a - b, which are exact where the
    /// columns nearly cancel: an end of the diameter all but touches the origin.
    static void boost(Vec3<Real>& a, Vec3<Real>& b) {
        const Real product = glm::dot(a, b);
        if (product == 0) {
            return;
        }
        const Vec3<Real> sum = product < 0 ? a + b : a - b;  // the shorter one
        const Vec3<Real> difference = product < 0 ? a - b : a + b;
        const Real squares = glm::dot(a, a) + glm::dot(b, b);
        const Real s = std::sqrt(glm::dot(sum, sum) * glm::dot(difference, difference)) / squares;  // √(1 - tanh² 2η)
        const Real cosh = std::sqrt((1 + s) / (2 * s));
        const Real t = std::min(Real(1), 2 * std::abs(product) / (squares * (1 + s)));
        const Real sign = product < 0 ? Real(1) : Real(-1);
        if (t < Real(0.5)) {
            // Sums would lose a column that is far shorter than the other.
            const Vec3<Real> boosted = cosh * (a + sign * t * b);
            b = cosh * (b + sign * t * a);
            a = boosted;
            return;
        }
        const Real one_minus_tanh = 2 * s / ((1 + s) * (1 + t));  // 1 - |tanh η|
        const Vec3<Real> boosted = cosh * (sum - sign * one_minus_tanh * b);
        b = cosh * (sign * sum - sign * one_minus_tanh * a);
        a = boosted;
    }

    Vec3<Real> c_, u_, v_;
};

template <class Real>
Ellipse<Real> scaled(const Ellipse<Real>& e) {
    Real largest = 0;
    for (const Vec3<Real>* v : {&e.center, &e.half_axis_u, &e.half_axis_v}) {
        largest = std::max({largest, std::abs(v->x), std::abs(v->y), std::abs(v->z)});
    }
    const Real scale = 1 / largest;
    return {e.center * scale, e.half_axis_u * scale, e.half_axis_v * scale};
}

template <class Real>
Real reach(const Ellipse<Real>& e) {
    return glm::length(e.center) + glm::length(e.half_axis_u) + glm::length(e.half_axis_v);
}

}  // namespace

template <class Real>
OriginPlace place_of_origin(const Ellipse<Real>& ellipse) {
    const Ellipse<Real> e = scaled(ellipse);
    const Vec3<Real> normal = glm::cross(e.half_axis_u, e.half_axis_v);
    if (std::abs(glm::dot(e.center, normal)) > kEdgeOn<Real> * reach(e) * glm::length(normal)) {
        return OriginPlace::beside_plane;
    }
    // center + a u + b v = 0 in the plane.
    const Real area = glm::dot(normal, normal);
    const Real a = glm::dot(glm::cross(e.half_axis_v, e.center), normal);
    const Real b = glm::dot(glm::cross(e.center, e.half_axis_u), normal);
    return a * a + b * b <= area * area ? OriginPlace::in_plane_inside : OriginPlace::in_plane_outside;
}

template <class Real>
SphericalEllipse<Real>::SphericalEllipse(const Ellipse<Real>& ellipse, bool clip) {
    const Ellipse<Real> e = scaled(ellipse);
    const Real rise = std::hypot(e.half_axis_u.z, e.half_axis_v.z);
    if (place_of_origin(e) != OriginPlace::beside_plane || (clip && e.center.z <= -rise)) {
        return;
    }
    Ellipse<Real> principal = ColumnRotations<Real>(e).columns();
    Real distance = glm::length(principal.center);
    Real half_long = glm::length(principal.half_axis_u);
    Real half_short = glm::length(principal.half_axis_v);
    if (half_long < half_short) {
        std::swap(half_long, half_short);
        std::swap(principal.half_axis_u, principal.half_axis_v);
    }
    // A column that is short beside the others comes from their difference, and has a direction of fewer digits: the
    // two longer columns give all three.
    if (distance < half_short) {
        const Vec3<Real> away = glm::cross(principal.half_axis_u, principal.half_axis_v);
        cone_.axis = glm::normalize(glm::dot(away, principal.center) < 0 ? -away : away);
    } else {
        cone_.axis = principal.center / distance;
    }
    cone_.long_axis = glm::normalize(principal.half_axis_u - glm::dot(principal.half_axis_u, cone_.axis) * cone_.axis);
    cone_.short_axis = glm::cross(cone_.long_axis, cone_.axis);
    if (glm::dot(cone_.short_axis, principal.half_axis_v) < 0) {
        principal.half_axis_v = -principal.half_axis_v;
    }
    const Real over_long = 1 / std::hypot(distance, half_long);
    const Real over_short = 1 / std::hypot(distance, half_short);
    cone_.sin_long = half_long * over_long;
    cone_.cos_long = distance * over_long;
    cone_.sin_short = half_short * over_short;
    cone_.cos_short = distance * over_short;
    cone_.complement = std::min(Real(1), cone_.cos_long / cone_.cos_short);
    functions_.emplace(cone_.complement);
    empty_ = false;
    if (clip && e.center.z < rise) {
        cut_by_horizon(e, principal);
    }
    measure();
}

/// z along the boundary is c_z + v_z cos τ + u_z sin τ. Its discriminant is the same for all parametrisations.
template <class Real>
void SphericalEllipse<Real>::cut_by_horizon(const Ellipse<Real>& given, const Ellipse<Real>& principal) {
    const Real rise = std::hypot(given.half_axis_u.z, given.half_axis_v.z);
    const Real root = std::sqrt((rise - given.center.z) * (rise + given.center.z));
    const Vec3<Real>& c = principal.center;
    const Vec3<Real>& v = principal.half_axis_v;
    const Vec3<Real>& u = principal.half_axis_u;
    const Real highest = std::atan2(u.z, v.z);
    const Real reach = std::atan2(root, -c.z);
    // The points at which the horizon cuts: the middle of their chord, and half of it.
    const Real over_rise = 1 / std::hypot(c.z, root);
    const Real cos_highest = v.z * over_rise;
    const Real sin_highest = u.z * over_rise;
    const Vec3<Real> middle = c - (c.z * over_rise) * (cos_highest * v + sin_highest * u);
    const Vec3<Real> half = (root * over_rise) * (cos_highest * u - sin_highest * v);
    const Vec3<Real> from = middle - half;
    const Vec3<Real> to = middle + half;
    HorizonCut<Real> cut;
    const auto level = [](const Vec3<Real>& p) {
        const Real length = std::hypot(p.x, p.y);
        return Vec3<Real>(p.x / length, p.y / length, 0);
    };
    cut.first = level(from);
    cut.last = level(to);
    const Real cross = 2 * (to.y * half.x - to.x * half.y);  // z of to × (from - to)
    cut.angle = std::atan2(std::max(Real(0), cross), to.x * from.x + to.y * from.y);
    cut.from = functions_->argument(highest - reach);
    cut.to = functions_->argument(highest + reach);
    const Vec3<Real> up = cos_highest * v + sin_highest * u;
    const Vec3<Real> along = cos_highest * u - sin_highest * v;
    const Real cos_half = std::cos(reach / 2);
    const Real sin_half = std::sin(reach / 2);
    cut.rising = glm::normalize(c + cos_half * up - sin_half * along);
    cut.highest = glm::normalize(c + up);
    cut.falling = glm::normalize(c + cos_half * up + sin_half * along);
    cut_ = cut;
}

template <class Real>
Vec3<Real> SphericalEllipse<Real>::direction(Real u) const {
    const auto f = functions_->at(u);
    return cone_.sin_long * f.sn * cone_.long_axis + cone_.sin_short * f.cn * cone_.short_axis +
           cone_.cos_short * f.dn * cone_.axis;
}

template <class Real>
void SphericalEllipse<Real>::measure() {
    constexpr Real kPi = std::numbers::pi_v<Real>;
    if (!cut_) {
        // The irradiance of the cone at right angles to its axis.
        least_solid_angle_ = kPi * cone_.sin_long * cone_.sin_short;
        const Real along = std::atan2(cone_.sin_long, cone_.cos_long);
        const Real across = std::atan2(cone_.sin_short, cone_.cos_short);
        boundary_ = 2 * kPi * std::sqrt((along * along + across * across) / 2);
        return;
    }
    const std::array<Vec3<Real>, 5> points = {cut_->first, cut_->rising, cut_->highest, cut_->falling, cut_->last};
    boundary_ = cut_->angle;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        boundary_ += glm::length(points[i + 1] - points[i]);
        if (i > 0) {
            least_solid_angle_ += std::abs(triangle_solid_angle(points[0], points[i], points[i + 1]));
        }
    }
}

template class SphericalEllipse<double>;
template class SphericalEllipse<long double>;
template OriginPlace place_of_origin(const Ellipse<double>&);
template OriginPlace place_of_origin(const Ellipse<long double>&);

}  // namespace shlight
