// SPDX-License-Identifier: MIT
#include "lights/ellipse_sampling.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shlight {
namespace {

using std::numbers::pi;

/// Number of meridians in the midpoint rule for the solid angle.
constexpr int kMeridians = 32;

double square(double x) {
    return x * x;
}

/// 2 sin(α/2) from sin α and cos α: the radius in Lambert's equal-area projection.
double equal_area(double sine, double cosine) {
    return std::sqrt(2 / (1 + cosine)) * sine;
}

}  // namespace

EllipseSampler::EllipseSampler(const Ellipse& disk)
    : ellipse_(disk, true),
      normal_(glm::normalize(glm::cross(disk.half_axis_u, disk.half_axis_v))),
      height_(glm::dot(normal_, disk.center)) {
    if (ellipse_.empty()) {
        return;
    }
    const Cone& cone = ellipse_.cone();
    long_ = equal_area(cone.sin_long, cone.cos_long);
    short_ = equal_area(cone.sin_short, cone.cos_short);
    cot_square_long_ = square(cone.cos_long / cone.sin_long);
    cot_square_short_ = square(cone.cos_short / cone.sin_short);
    widest_ = pi;
    if (ellipse_.cut() && cone.axis.z < 0) {
        const auto parameter = [&](const Vec3d& direction) {
            return std::atan2(glm::dot(direction, cone.long_axis) / long_,
                              glm::dot(direction, cone.short_axis) / short_);
        };
        const double first = parameter(ellipse_.cut()->first);
        double last = parameter(ellipse_.cut()->last);
        last += last < first ? 2 * pi : 0;
        middle_ = (first + last) / 2;
        widest_ = (last - first) / 2;
    }
}

EllipseSampler::Meridian EllipseSampler::meridian(const Turn& parameter) const {
    const Cone& cone = ellipse_.cone();
    const double along = long_ * parameter.sine;
    const double across = short_ * parameter.cosine;
    const double radius_square = along * along + across * across;
    const double over = 1 / std::sqrt(radius_square);
    Meridian line{(along * over) * cone.long_axis + (across * over) * cone.short_axis, 0, 0, 0};
    // The meridian ends at the rim, whose half angle has this squared cotangent.
    const double cot_square = square(along * over) * cot_square_long_ + square(across * over) * cot_square_short_;
    const double sine_square = 1 / (1 + cot_square);
    line.to = sine_square / (1 + std::sqrt(cot_square * sine_square));
    const double height = cone.axis.z;
    const double slope = line.across.z;
    if (ellipse_.cut() && (height >= 0) != (slope >= 0)) {
        // The horizon crosses where tan(angle) = -height / slope, as in CapSampler.
        const double length = std::sqrt(height * height + slope * slope);
        const double crossing = height * height / (length * (length + std::abs(slope)));
        (height >= 0 ? line.to : line.from) = std::min(line.to, crossing);
    } else if (height < 0) {
        line.to = 0;
    }
    line.weight = (line.to - line.from) * long_ * short_ / radius_square;
    return line;
}

LightSample EllipseSampler::sample(const glm::dvec2& point) const {
    if (ellipse_.empty()) {
        return {Vec3d(0, 0, 1), 0, 0};
    }
    const Meridian line = meridian(Turn(middle_ + widest_ * (2 * point.y - 1)));
    const double drop = line.from + point.x * (line.to - line.from);
    const Vec3d direction = (1 - drop) * ellipse_.cone().axis + std::sqrt(drop * (2 - drop)) * line.across;
    return {direction, distance(direction), 2 * widest_ * line.weight};
}

double EllipseSampler::solid_angle() const {
    if (ellipse_.empty()) {
        return 0;
    }
    // The four quarters of an uncut light have the same solid angle.
    const bool whole = !ellipse_.cut();
    const int count = whole ? kMeridians / 4 : kMeridians;
    const double range = whole ? pi / 2 : 2 * widest_;
    const Turn step(range / count);
    Turn parameter((whole ? 0 : middle_ - widest_) + range / count / 2);
    double sum = 0;
    for (int i = 0; i < count; ++i, parameter = parameter.then(step)) {
        sum += meridian(parameter).weight;
    }
    return 2 * widest_ * sum / count;
}

std::optional<double> EllipseSampler::meets(const Vec3d& direction) const {
    if (ellipse_.empty()) {
        return std::nullopt;
    }
    const Cone& cone = ellipse_.cone();
    const double ahead = glm::dot(direction, cone.axis);
    const double off = square(glm::dot(direction, cone.long_axis)) * cot_square_long_ +
                       square(glm::dot(direction, cone.short_axis)) * cot_square_short_;
    return ahead > 0 && off <= ahead * ahead ? std::optional(distance(direction)) : std::nullopt;
}

}  // namespace shlight
