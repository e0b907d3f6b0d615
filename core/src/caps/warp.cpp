// SPDX-License-Identifier: MIT
#include "shlight/warp.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/exact_sums.h"
#include "base/safe_length.h"

namespace shlight {
namespace {

double squared_length(const Vec3d& v) {
    return glm::dot(v, v);
}

}  // namespace

Circle circle_of_sphere(const Vec3d& center, double radius) {
    const double scale = safe_scale(center);
    const Vec3d c = center * scale;
    const double r = radius * scale;
    const double tangent_squared = std::max(0.0, difference_of_squares({c.x, c.y, c.z}, r));
    const double inverse = 1 / glm::length(c);
    return {c * inverse, std::sqrt(tangent_squared) * inverse, std::min(1.0, r * inverse)};
}

Circle circle_of_facing_disk(const Vec3d& center, double radius) {
    const double distance = safe_length(center);
    const double slant = std::hypot(distance, radius);
    return {center / distance, distance / slant, radius / slant};
}

Circle circle_about_axis(const Vec3d& axis, double half_angle) {
    const double half = std::min(half_angle, std::numbers::pi);
    const Vec3d scaled = axis * safe_scale(axis);
    return {scaled / glm::length(scaled), std::cos(half), std::sin(half)};
}

Warp::Warp(double tilt, double narrowness) : sin_tilt_(std::sin(tilt)), cos_tilt_(std::cos(tilt)) {
    const double r = 1 - narrowness;
    const double scale = 1 + r * r;
    speed_ = 2 * r / scale;
    one_minus_speed_ = narrowness * narrowness / scale;
    gamma_ = scale / (narrowness * (1 + r));
    // The horizon is the circle (0; z): its image is (-γ b cos t; sin t, 0, γ cos t) in the boost's frame.
    const double length = std::hypot(sin_tilt_, gamma_ * cos_tilt_);
    horizon_x_ = sin_tilt_ / length;
    horizon_z_ = gamma_ * cos_tilt_ / length;
    horizon_height_ = -gamma_ * speed_ * cos_tilt_ / length;
    horizon_sine_ = 1 / length;
}

Vec3d Warp::warped(const Vec3d& direction) const {
    const double gap = squared_length(direction - axis()) / 2;  // 1 - ω·axis, which a strong boost would cancel
    const double across = cos_tilt_ * direction.x + sin_tilt_ * direction.z;
    // γ (ω·axis - b) and γ (1 - b ω·axis).
    const double along = gamma_ * (one_minus_speed_ - gap);
    const double time = gamma_ * (one_minus_speed_ + speed_ * gap);
    return Vec3d(horizon_z_ * across - horizon_x_ * along, direction.y, horizon_x_ * across + horizon_z_ * along) /
           time;
}

Vec3d Warp::direction(const Vec3d& warped) const {
    const Vec3d middle(-horizon_x_, 0, horizon_z_);  // the boost's axis, seen in the warped frame
    const double across = horizon_z_ * warped.x + horizon_x_ * warped.z;
    const double above = squared_length(warped + middle) / 2;  // 1 + u·axis
    // 1 + b u_∥ and u_∥ + b, as sums of what is small when the boost is strong and u opposite.
    const double weight = one_minus_speed_ + speed_ * above;
    const double along = (above - one_minus_speed_) / weight;
    const double side = across / (gamma_ * weight);
    return {cos_tilt_ * side - sin_tilt_ * along, warped.y / (gamma_ * weight), sin_tilt_ * side + cos_tilt_ * along};
}

double Warp::density(const Vec3d& warped) const {
    const Vec3d middle(-horizon_x_, 0, horizon_z_);
    const double weight = gamma_ * (one_minus_speed_ + speed_ * squared_length(warped + middle) / 2);
    return 1 / (weight * weight);
}

}  // namespace shlight
