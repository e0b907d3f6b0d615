// SPDX-License-Identifier: MIT
//
// A boost point by point, in 113 bits; no image of a circle enters. Included by the quad_*.cpp files only.
#pragma once

#include "quad_math.h"

namespace shlight::truth {

/// Directions ω ↔ u by the definition: about the axis the stereographic plane is stretched by `stretch`; then the frame
/// is turned until the image of the horizon lies level.
class PointwiseBoost {
  public:
    PointwiseBoost() = default;
    explicit PointwiseBoost(const BoostInput& input)
        : axis_{-sinf128(input.tilt), 0, cosf128(input.tilt)},
          stretch_((2 - quad(input.narrowness)) / input.narrowness) {
        const Vec3q right = image({1, 0, 0}).point;
        const Vec3q left = image({-1, 0, 0}).point;
        const Vec3q ahead = image({0, 1, 0}).point;
        const Vec3q normal = normalized(cross(ahead - right, left - right));
        // The rows of the turn about y; the boosted frame's z is the normal of the plane through three horizon points.
        z_ = normal;
        x_ = cross(Vec3q{0, 1, 0}, normal);
    }

    struct Image {
        Vec3q point, step;  ///< u and du/ds
        quad scale;         ///< |du/ds| for |dω/ds| = 1
        quad area;  ///< (μ - μ') / (1 - μ²), μ = ω·axis, μ' = u·axis: the area grows by its integral over dφ (1 - μ²)
    };

    /// step: dω/ds.
    Image image(const Vec3q& direction, const Vec3q& step = {0, 0, 0}) const {
        if (stretch_ == 1) {
            return {direction, step, 1, 0};  // the plane has no room for -axis
        }
        const quad above = 1 + dot(direction, axis_);
        const quad rise = dot(step, axis_);
        const Vec3q plane = (1 / above) * (direction + axis_) - axis_;
        const Vec3q plane_step = (1 / above) * (step - (rise / above) * (direction + axis_));
        const quad squared = dot(plane, plane);
        const quad divisor = 1 + stretch_ * stretch_ * squared;
        const quad divisor_step = 2 * stretch_ * stretch_ * dot(plane, plane_step);
        const Vec3q numerator = (2 * stretch_) * plane + 2 * axis_;
        const Vec3q u = (1 / divisor) * numerator - axis_;
        const Vec3q du = (1 / divisor) * ((2 * stretch_) * plane_step - (divisor_step / divisor) * numerator);
        return {turned(u), turned(du), stretch_ * (1 + squared) / divisor,
                (stretch_ * stretch_ - 1) * (1 + squared) / (2 * divisor)};
    }
    const Vec3q& axis() const { return axis_; }
    quad stretch() const { return stretch_; }

  private:
    Vec3q turned(const Vec3q& v) const { return {dot(x_, v), v.y, dot(z_, v)}; }

    Vec3q axis_{0, 0, 1};
    quad stretch_ = 1;
    Vec3q x_{1, 0, 0}, z_{0, 0, 1};
};

}  // namespace shlight::truth
