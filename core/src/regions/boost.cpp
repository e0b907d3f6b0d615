// SPDX-License-Identifier: MIT
#include "shlight/boost.h"

#include <cmath>

namespace shlight {
namespace {

double squared_length(const Vec3d& v) {
    return glm::dot(v, v);
}

}  // namespace

Boost::Boost(double tilt, double narrowness) : sin_tilt_(std::sin(tilt)), cos_tilt_(std::cos(tilt)) {
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

Vec3d Boost::boosted(const Vec3d& direction) const {
    const double gap = squared_length(direction - axis()) / 2;  // 1 - ω·axis, which a strong boost would cancel
    const double across = cos_tilt_ * direction.x + sin_tilt_ * direction.z;
    // γ (ω·axis - b) and γ (1 - b ω·axis).
    const double along = gamma_ * (one_minus_speed_ - gap);
    const double time = gamma_ * (one_minus_speed_ + speed_ * gap);
    return Vec3d(horizon_z_ * across - horizon_x_ * along, direction.y, horizon_x_ * across + horizon_z_ * along) /
           time;
}

Vec3d Boost::direction(const Vec3d& boosted) const {
    const Vec3d middle(-horizon_x_, 0, horizon_z_);  // the boost's axis, seen in the boosted frame
    const double across = horizon_z_ * boosted.x + horizon_x_ * boosted.z;
    const double above = squared_length(boosted + middle) / 2;  // 1 + u·axis
    // 1 + b u_∥ and u_∥ + b, as sums of what is small when the boost is strong and u opposite.
    const double weight = one_minus_speed_ + speed_ * above;
    const double along = (above - one_minus_speed_) / weight;
    const double side = across / (gamma_ * weight);
    return {cos_tilt_ * side - sin_tilt_ * along, boosted.y / (gamma_ * weight), sin_tilt_ * side + cos_tilt_ * along};
}

double Boost::density(const Vec3d& boosted) const {
    const Vec3d middle(-horizon_x_, 0, horizon_z_);
    const double weight = gamma_ * (one_minus_speed_ + speed_ * squared_length(boosted + middle) / 2);
    return 1 / (weight * weight);
}

}  // namespace shlight
