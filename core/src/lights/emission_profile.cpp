// SPDX-License-Identifier: MIT
#include "shlight/emission_profile.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <glm/matrix.hpp>

#include "base/checks.h"
#include "base/perpendicular.h"
#include "base/unit_direction.h"

namespace shlight {
namespace {

using std::numbers::pi;

constexpr double kEvenSpread = 1e-6;      // [rad] below π
constexpr double kLeastVolume = 1e-12;    // volume of three axes ÷ the product of their lengths
constexpr double kSmallHalfAngle = 0.01;  // [rad]

/// tan h - h, by its series where the difference would cancel.
double tangent_minus_angle(double h) {
    if (h < kSmallHalfAngle) {
        const double h2 = h * h;
        return h * h2 * (1.0 / 3 + h2 * (2.0 / 15 + h2 * (17.0 / 315)));
    }
    return std::tan(h) - h;
}

/// The map's condition number κ, the largest factor by which it enlarges angles. With singular values a ≥ b ≥ c, the
/// product of the squared Frobenius norms of the map and its inverse is 3 + Σ (r + 1/r) over the squared ratios r of
/// pairs, so that κ² + 1/κ² is at most this product minus 7.
double condition(const glm::dmat3& map) {
    const auto square = [](const glm::dmat3& m) {
        return glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]);
    };
    const double half = std::max(1.0, (square(map) * square(glm::inverse(map)) - 7) / 2);
    return std::sqrt(half + std::sqrt((half - 1) * (half + 1)));
}

double spot_factor(const SpotProfile& spot, double z) {
    if (!(z > spot.cosine)) {
        return 0;
    }
    const double rim = (1 - spot.cosine) * spot.blend;
    const double t = z - spot.cosine < rim ? (z - spot.cosine) / rim : 1.0;
    return t * t * (3 - 2 * t) * (spot.times_cosine ? z : 1.0);
}

double spread_factor(const SpreadProfile& spread, double angle) {
    return angle < spread.half_angle ? (spread.tangent - std::tan(angle)) * spread.scale : 0.0;
}

double tangent_factor(double cosine) {
    return 1 / (cosine * cosine * cosine);
}

/// The angle to a spot's axis, in the frame of the spot.
double spot_angle_of(const SpotProfile& spot, const Vec3d& direction) {
    return angle_between(spot.to_local * direction, {0, 0, 1});
}

struct Factor {
    const Vec3d& direction;

    double operator()(const EvenProfile& /*profile*/) const { return 1; }
    double operator()(const SpotProfile& spot) const {
        const Vec3d local = spot.to_local * direction;
        return spot_factor(spot, local.z / glm::length(local));
    }
    double operator()(const SpreadProfile& spread) const {
        const double cosine = glm::dot(spread.normal, direction);
        if (!(cosine > 0)) {
            return 0;
        }
        const double tangent = glm::length(glm::cross(spread.normal, direction)) / cosine;
        return std::max(0.0, spread.tangent - tangent) * spread.scale;
    }
    double operator()(const TangentProfile& sun) const { return tangent_factor(glm::dot(sun.axis, direction)); }
    double operator()(const TableProfile& own) const {
        return own.table->at(own.to_table * direction) * std::visit(*this, own.plain);
    }
};

struct Range {
    const Vec3d& direction;
    double half_angle;

    ProfileRange operator()(const EvenProfile& /*profile*/) const { return {1, 1}; }
    ProfileRange operator()(const SpotProfile& spot) const {
        const double middle = spot_angle_of(spot, direction);
        const double reach = half_angle * spot.stretch;
        return {spot_factor(spot, std::cos(std::min(pi, middle + reach))),
                spot_factor(spot, std::cos(std::max(0.0, middle - reach)))};
    }
    ProfileRange operator()(const SpreadProfile& spread) const {
        const double middle = angle_between(direction, spread.normal);
        return {spread_factor(spread, middle + half_angle), spread_factor(spread, std::max(0.0, middle - half_angle))};
    }
    ProfileRange operator()(const TangentProfile& sun) const {
        const double middle = angle_between(direction, sun.axis);
        return {tangent_factor(std::cos(std::max(0.0, middle - half_angle))),
                tangent_factor(std::cos(std::min(pi / 2, middle + half_angle)))};
    }
    ProfileRange operator()(const TableProfile& own) const {
        const ProfileRange plain = std::visit(*this, own.plain);
        const ProfileRange listed = own.table->range(own.to_table * direction, half_angle);
        return {plain.low * listed.low, plain.high * listed.high};
    }
};

struct Scale {
    const Vec3d& direction;

    double operator()(const EvenProfile& /*profile*/) const { return 1; }
    double operator()(const SpotProfile& spot) const {
        const double outer = std::acos(spot.cosine);
        const double inner = std::acos(spot.cosine + (1 - spot.cosine) * spot.blend);
        const double angle = spot_angle_of(spot, direction);
        return std::min(1.0, (outer - inner + std::max({0.0, angle - outer, inner - angle})) / spot.stretch);
    }
    double operator()(const SpreadProfile& spread) const {
        return std::min(1.0, std::max(spread.half_angle, angle_between(direction, spread.normal)));
    }
    double operator()(const TangentProfile& /*sun*/) const { return 1; }
    double operator()(const TableProfile& own) const {
        return std::min(own.table->scale(own.to_table * direction), std::visit(*this, own.plain));
    }
};

struct Plain {
    PlainProfile operator()(const TableProfile& own) const { return own.plain; }
    template <class Profile>
    PlainProfile operator()(const Profile& own) const {
        return own;
    }
};

}  // namespace

glm::dmat3 lamp_axes(const Vec3d& direction) {
    const Vec3d z = -unit_direction(direction);
    const Vec3d x = perpendicular(z);
    return {x, glm::cross(z, x), z};
}

SpotProfile make_spot_profile(const glm::dmat3& axes, double spot_angle, double blend, bool times_cosine) {
    for (int i = 0; i < 3; ++i) {
        check_finite("direction", axes[i]);
    }
    const double volume = std::abs(glm::determinant(axes));
    if (!(volume > kLeastVolume * glm::length(axes[0]) * glm::length(axes[1]) * glm::length(axes[2]))) {
        reject("direction: its axes lie in a plane");
    }
    if (!(spot_angle > 0 && spot_angle <= pi * (1 + 1e-6))) {
        reject("spot_angle must be positive and at most pi");
    }
    if (!(blend >= 0 && blend <= 1)) {
        reject("blend must be 0 … 1");
    }
    // A lamp shines along its -z.
    glm::dmat3 to_local = glm::inverse(axes);
    for (int column = 0; column < 3; ++column) {
        to_local[column].z = -to_local[column].z;
    }
    return {to_local, condition(to_local), std::max(0.0, std::cos(spot_angle / 2)), blend, times_cosine};
}

EmissionProfile make_spread_profile(const Vec3d& normal, double spread) {
    if (!(spread > 0 && spread <= pi * (1 + 1e-6))) {
        reject("spread must be positive and at most pi");
    }
    if (spread > pi - kEvenSpread) {
        return EvenProfile{};
    }
    const double h = spread / 2;
    return SpreadProfile{glm::normalize(normal), h, std::tan(h), 1 / tangent_minus_angle(h)};
}

TableProfile with_table(const EmissionProfile& profile, std::shared_ptr<const DirectionTable> table,
                        const glm::dmat3& to_table) {
    return {std::move(table), to_table, std::visit(Plain{}, profile)};
}

double profile_factor(const EmissionProfile& profile, const Vec3d& direction) {
    return std::visit(Factor{direction}, profile);
}

ProfileRange profile_range(const EmissionProfile& profile, const Vec3d& direction, double half_angle) {
    return std::visit(Range{direction, half_angle}, profile);
}

double profile_scale(const EmissionProfile& profile, const Vec3d& direction) {
    return std::visit(Scale{direction}, profile);
}

}  // namespace shlight
