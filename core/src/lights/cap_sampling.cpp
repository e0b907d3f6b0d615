// SPDX-License-Identifier: MIT
#include "lights/cap_sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "shlight/cap.h"

namespace shlight {
namespace {

using std::numbers::pi;

}  // namespace

CapSampler::CapSampler(const CapView& cap)
    : cap_(cap), distance_(glm::length(cap.center)), axis_(0, 0, 1), up_(1, 0, 0), across_(0, 1, 0), widest_(pi) {
    if (cap.kind == CapView::Kind::inside) {
        return;  // the whole hemisphere
    }
    axis_ = cap.center / distance_;
    axis_height_ = axis_.z;
    tilt_ = std::hypot(axis_.x, axis_.y);
    if (tilt_ > 0) {
        up_ = Vec3d(-axis_.x * axis_.z, -axis_.y * axis_.z, tilt_ * tilt_) / tilt_;
        across_ = glm::cross(axis_, up_);
    }
    const bool sphere = cap.kind != CapView::Kind::facing_disk;
    const double sine = cap.radius / (sphere ? distance_ : std::hypot(distance_, cap.radius));
    const double cosine = sphere ? std::sqrt(std::max(0.0, (1 - sine) * (1 + sine))) : sine * distance_ / cap.radius;
    one_minus_cos_ = sine * sine / (1 + cosine);
    sine_ = sine;
    cut_ = axis_height_ < sine;
    if (axis_height_ < 0) {
        widest_ = std::acos(std::clamp(-axis_height_ * cosine / (tilt_ * sine), -1.0, 1.0));
    }
}

LightSample CapSampler::sample(const glm::dvec2& point) const {
    const double azimuth = widest_ * (2 * point.y - 1);
    const double toward_up = std::cos(azimuth);
    double from = 0;  // range of 1 - cos of the angle to the axis
    double to = one_minus_cos_;
    // The horizon crosses this meridian at the angle to the axis with tan(angle) = -height / (tilt · toward_up).
    const double slope = tilt_ * toward_up;
    if (cut_ && (axis_height_ >= 0) != (slope >= 0)) {
        const double length = std::sqrt(axis_height_ * axis_height_ + slope * slope);
        const double crossing = axis_height_ * axis_height_ / (length * (length + std::abs(slope)));
        (axis_height_ >= 0 ? to : from) = std::min(one_minus_cos_, crossing);
    }
    const double drop = from + point.x * (to - from);
    const double sine = std::sqrt(drop * (2 - drop));
    const Vec3d direction = (1 - drop) * axis_ + (sine * toward_up) * up_ + (sine * std::sin(azimuth)) * across_;
    return {direction, distance(direction, 1 - drop), 2 * widest_ * (to - from)};
}

double CapSampler::solid_angle() const {
    return cut_ ? clipped_solid_angle(circle_of(cap_)) : 2 * pi * one_minus_cos_;
}

std::optional<double> CapSampler::meets(const Vec3d& direction) const {
    const double cosine = glm::dot(direction, axis_);
    // Compared by the sine, because cosines of small caps are all nearly 1.
    if (cap_.kind != CapView::Kind::inside && !(cosine > 0 && glm::length(glm::cross(direction, axis_)) <= sine_)) {
        return std::nullopt;
    }
    return distance(direction, cosine);
}

double CapSampler::distance(const Vec3d& direction, double cosine) const {
    if (cap_.kind == CapView::Kind::infinite) {
        return std::numeric_limits<double>::infinity();
    }
    if (cap_.kind == CapView::Kind::facing_disk) {
        return distance_ / cosine;
    }
    const double along = glm::dot(direction, cap_.center);
    const double rest = (cap_.radius - distance_) * (cap_.radius + distance_) + along * along;
    const double half_chord = std::sqrt(std::max(0.0, rest));
    return cap_.kind == CapView::Kind::sphere ? std::max(0.0, along - half_chord) : along + half_chord;
}

}  // namespace shlight
