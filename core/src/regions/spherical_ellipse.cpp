// SPDX-License-Identifier: MIT
#include "regions/spherical_ellipse.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/exact_sums.h"
#include "base/ray_rounding.h"
#include "base/safe_length.h"

namespace shlight {
namespace {

/// The directions to an ellipse are c + u cos τ + v sin τ, and (1, cos τ, sin τ) has length zero in the metric (+, -,
/// -). Any turn or boost of the three columns is another parametrisation of the same boundary. Jacobi's rotations,
/// hyperbolic ones for pairs with the first column, make the columns orthogonal: the principal axes of the cone.
class ColumnRotations {
  public:
    explicit ColumnRotations(const Ellipse& ellipse)
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

    Ellipse columns() const { return {c_, u_, v_}; }

  private:
    static bool small(const Vec3d& a, const Vec3d& b) {
        constexpr double kSquare = std::numeric_limits<double>::epsilon() / 64;
        const double product = glm::dot(a, b);
        return product * product <= kSquare * glm::dot(a, a) * glm::dot(b, b);
    }
    bool nearly_orthogonal() const { return small(u_, v_) && small(c_, u_) && small(c_, v_); }

    /// tan 2φ = 2 a·b / (a² - b²), the smaller of both φ.
    static void turn(Vec3d& a, Vec3d& b) {
        const double twice = 2 * glm::dot(a, b);
        if (twice == 0) {
            return;
        }
        const double difference = glm::dot(a, a) - glm::dot(b, b);
        const double root = std::hypot(difference, twice);  // squares of what is all but orthogonal may be 0
        const double tangent = twice / (difference < 0 ? difference - root : difference + root);
        const double c = 1 / std::sqrt(1 + tangent * tangent);
        const double s = tangent * c;
        const Vec3d turned = c * a + s * b;
        b = c * b - s * a;
        a = turned;
    }

    /// tanh 2η = -2 a·b / (a² + b²). Its distance to ±1 is formed from a + b and a - b, which are exact where the
    /// columns nearly cancel: an end of the diameter all but touches the origin.
    static void boost(Vec3d& a, Vec3d& b) {
        const double product = glm::dot(a, b);
        if (product == 0) {
            return;
        }
        const Vec3d sum = product < 0 ? a + b : a - b;  // the shorter one
        const Vec3d difference = product < 0 ? a - b : a + b;
        const double squares = glm::dot(a, a) + glm::dot(b, b);
        const double s = std::sqrt(glm::dot(sum, sum) * glm::dot(difference, difference)) / squares;  // √(1 - tanh² 2η)
        const double cosh = std::sqrt((1 + s) / (2 * s));
        const double t = std::min(1.0, 2 * std::abs(product) / (squares * (1 + s)));
        const double sign = product < 0 ? 1.0 : -1.0;
        if (t < 0.5) {
            // Sums would lose a column that is far shorter than the other.
            const Vec3d boosted = cosh * (a + sign * t * b);
            b = cosh * (b + sign * t * a);
            a = boosted;
            return;
        }
        const double one_minus_tanh = 2 * s / ((1 + s) * (1 + t));  // 1 - |tanh η|
        const Vec3d boosted = cosh * (sum - sign * one_minus_tanh * b);
        b = cosh * (sign * sum - sign * one_minus_tanh * a);
        a = boosted;
    }

    Vec3d c_, u_, v_;
};

/// In a unit in which the largest coordinate is about 1, without rounding.
Ellipse scaled(const Ellipse& e) {
    const double scale = power_of_two_scale(
        std::max({largest_component(e.center), largest_component(e.half_axis_u), largest_component(e.half_axis_v)}));
    return {e.center * scale, e.half_axis_u * scale, e.half_axis_v * scale};
}

/// The origin lies in the plane of an ellipse if its distance from there is at most this part of its reach.
constexpr double kOnPlane = 0x1p-57;

double reach(const Ellipse& e) {
    return glm::length(e.center) + glm::length(e.half_axis_u) + glm::length(e.half_axis_v);
}

}  // namespace

OriginPlace place_of_origin(const Ellipse& ellipse) {
    const Ellipse e = scaled(ellipse);
    const Vec3d normal = glm::cross(e.half_axis_u, e.half_axis_v);
    if (std::abs(triple_product(e.center, e.half_axis_u, e.half_axis_v)) > kOnPlane * reach(e) * glm::length(normal)) {
        return OriginPlace::beside_plane;
    }
    // center + a u + b v = 0 in the plane.
    const double area = glm::dot(normal, normal);
    const double a = glm::dot(glm::cross(e.half_axis_v, e.center), normal);
    const double b = glm::dot(glm::cross(e.center, e.half_axis_u), normal);
    return a * a + b * b <= area * area ? OriginPlace::in_plane_inside : OriginPlace::in_plane_outside;
}

SphericalEllipse::SphericalEllipse(const Ellipse& ellipse, bool clip) {
    const Ellipse e = scaled(ellipse);
    const double rise = std::hypot(e.half_axis_u.z, e.half_axis_v.z);
    if (place_of_origin(e) != OriginPlace::beside_plane || (clip && e.center.z <= -rise)) {
        return;
    }
    Ellipse principal = ColumnRotations(e).columns();
    double distance = glm::length(principal.center);
    double half_long = glm::length(principal.half_axis_u);
    double half_short = glm::length(principal.half_axis_v);
    // Neither turns nor boosts change it.
    double volume = triple_product(e.center, e.half_axis_u, e.half_axis_v);
    if (half_long < half_short) {
        std::swap(half_long, half_short);
        std::swap(principal.half_axis_u, principal.half_axis_v);
        volume = -volume;
    }
    // A column that is short beside the others comes from their difference, and has fewer digits, or none: the two
    // longer columns give all directions, and with the volume the third length.
    (distance < half_short ? distance : half_short) = std::abs(volume) / (half_long * std::max(distance, half_short));
    if (distance < half_short) {
        const Vec3d away = glm::cross(principal.half_axis_u, principal.half_axis_v);
        cone_.axis = glm::normalize(volume < 0 ? -away : away);
    } else {
        cone_.axis = principal.center / distance;
    }
    cone_.long_axis = glm::normalize(principal.half_axis_u - glm::dot(principal.half_axis_u, cone_.axis) * cone_.axis);
    cone_.short_axis = glm::cross(cone_.long_axis, cone_.axis);
    if (glm::dot(cone_.short_axis, principal.half_axis_v) < 0) {
        principal.half_axis_v = -principal.half_axis_v;
    }
    const double over_long = 1 / std::hypot(distance, half_long);
    const double over_short = 1 / std::hypot(distance, half_short);
    cone_.sin_long = half_long * over_long;
    cone_.cos_long = distance * over_long;
    cone_.sin_short = half_short * over_short;
    cone_.cos_short = distance * over_short;
    cone_.complement = std::min(1.0, cone_.cos_long / cone_.cos_short);
    functions_.emplace(cone_.complement);
    empty_ = false;
    if (clip && e.center.z < rise) {
        cut_by_horizon(e, principal, over_short);
    }
    measure();
}

/// z along the boundary is c_z + v_z cos τ + u_z sin τ. Its discriminant is the same for all parametrisations.
void SphericalEllipse::cut_by_horizon(const Ellipse& given, const Ellipse& principal, double scale) {
    const double root =
        std::sqrt(std::max(0.0, difference_of_squares({given.half_axis_u.z, given.half_axis_v.z, 0}, given.center.z)));
    const Vec3d& c = principal.center;
    const Vec3d& v = principal.half_axis_v;
    const Vec3d& u = principal.half_axis_u;
    const double highest = std::atan2(u.z, v.z);
    const double reach = std::atan2(root, -c.z);
    // The points at which the horizon cuts: the middle of their chord, and half of it.
    const double rise = std::hypot(c.z, root);
    const double over_rise = 1 / rise;
    const double cos_highest = v.z * over_rise;
    const double sin_highest = u.z * over_rise;
    const Vec3d middle = c - (c.z * over_rise) * (cos_highest * v + sin_highest * u);
    const Vec3d half = (root * over_rise) * (cos_highest * u - sin_highest * v);
    const Vec3d from = middle - half;
    const Vec3d to = middle + half;
    HorizonCut cut;
    const auto level = [](const Vec3d& p) {
        const double length = std::hypot(p.x, p.y);
        return Vec3d(p.x / length, p.y / length, 0);
    };
    cut.first = level(from);
    cut.last = level(to);
    const double cross = 2 * (to.y * half.x - to.x * half.y);  // z of to × (from - to)
    cut.angle = std::atan2(std::max(0.0, cross), to.x * from.x + to.y * from.y);
    cut.from = functions_->argument(highest - reach);
    cut.to = functions_->argument(highest + reach);
    const Vec3d up = cos_highest * v + sin_highest * u;
    const Vec3d along = cos_highest * u - sin_highest * v;
    const double cos_half = std::cos(reach / 2);
    const double sin_half = std::sin(reach / 2);
    cut.rising = glm::normalize(c + cos_half * up - sin_half * along);
    cut.highest = glm::normalize(c + up);
    cut.falling = glm::normalize(c + cos_half * up + sin_half * along);
    cut.rise = rise * scale;
    cut.reach = reach;
    cut.cos_highest = cos_highest;
    cut.sin_highest = sin_highest;
    cut_ = cut;
}

Vec3d SphericalEllipse::direction(double u) const {
    const auto f = functions_->at(u);
    return cone_.sin_long * f.sn * cone_.long_axis + cone_.sin_short * f.cn * cone_.short_axis +
           cone_.cos_short * f.dn * cone_.axis;
}

/// c_z + v_z cos τ + u_z sin τ is rise (cos δ - cos reach), with δ the angle from the highest point.
double SphericalEllipse::height(const EllipticFunctions::Values& f) const {
    const double sine = cone_.complement * f.sn;
    const double angle = std::atan2(sine * cut_->cos_highest - f.cn * cut_->sin_highest,
                                    f.cn * cut_->cos_highest + sine * cut_->sin_highest);
    return 2 * cut_->rise * std::sin((cut_->reach - angle) / 2) * std::sin((cut_->reach + angle) / 2) * f.dn;
}

Vec3d horizon_middle(const HorizonCut& cut) {
    const double c = std::cos(cut.angle / 2);
    const double s = std::sin(cut.angle / 2);
    return {cut.last.x * c - cut.last.y * s, cut.last.x * s + cut.last.y * c, 0};
}

void SphericalEllipse::measure() {
    if (!cut_) {
        // The irradiance of the cone at right angles to its axis.
        least_solid_angle_ = std::numbers::pi * cone_.sin_long * cone_.sin_short;
        const double along = std::atan2(cone_.sin_long, cone_.cos_long);
        const double across = std::atan2(cone_.sin_short, cone_.cos_short);
        boundary_ = 2 * std::numbers::pi * std::sqrt((along * along + across * across) / 2);
        return;
    }
    // Triangles meet in the middle of the arc of the horizon: in an end of it, which may lie opposite to the other,
    // they would not tell a lune from nothing.
    const Vec3d middle = horizon_middle(*cut_);
    const std::array<Vec3d, 5> points = {cut_->first, cut_->rising, cut_->highest, cut_->falling, cut_->last};
    boundary_ = cut_->angle;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        boundary_ += glm::length(points[i + 1] - points[i]);
        least_solid_angle_ += std::abs(triangle_solid_angle(middle, points[i], points[i + 1]));
    }
}

}  // namespace shlight
