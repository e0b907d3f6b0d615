// SPDX-License-Identifier: MIT
//
// The edge of a smooth surface's own shadow. Its triangles are flat and shade each other there, where a smooth surface
// would still be lit. The rules are those of Cycles' Shadow Terminator: Geometry Offset, after Chiang, Li & Burley
// 2019, "Taming the Shadow Terminator", and Shading Offset.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "shlight/types.h"

namespace shlight {

/// Shadow rays of one hit start on its triangle, or, if they are as flat as the light at the shadow's edge, on the
/// smooth surface that the triangle stands for; and a part of the light is let in.
struct Terminator {
    Vec3d lift{0};                  ///< from the triangle to the smooth surface
    Vec3d smooth{0}, geometric{0};  ///< unit normals of both, on the viewer's side
    double cutoff = 0;              ///< cosine of the light below which rays start on the smooth surface; 0: none does
    double frequency = 1;           ///< light ends at an angle of π / 2 ÷ this to the normal
    bool glossy = false;            ///< rays below the smooth surface's horizon start on the triangle

    bool lifts() const { return cutoff > 0; }
    /// How much of the lift a ray has, 0 … 1. direction: unit, towards the light.
    double share(const Vec3d& direction) const {
        const double above_smooth = glm::dot(smooth, direction);
        const double above_flat = glm::dot(geometric, direction);
        if (glossy && above_smooth < 0) {
            return 0;
        }
        const double least = above_smooth < cutoff ? above_smooth + above_flat - cutoff : above_flat;
        return std::clamp(1 - least / cutoff, 0.0, 1.0);
    }

    bool dims() const { return frequency > 1; }
    /// The part of the light from a direction that is let in. cosine: of its angle to the normal of a lobe.
    double let_in(double cosine) const {
        if (!dims()) {
            return 1;
        }
        const double within = std::min(cosine, 1.0);
        return within > 0 ? std::max(std::cos(frequency * std::acos(within)), 0.0) / within : 0.0;
    }
};

/// The point of a triangle, or the normal there, of which the corners have these shares.
inline Vec3d weighted(const std::array<Vec3d, 3>& corners, const std::array<double, 3>& weights) {
    return weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
}

/// The way from a point of a triangle to the smooth surface that its corners' normals describe, not to its back.
/// normals: unit, on the viewer's side; weights: of the corners, of sum 1.
Vec3d lift_to_smooth_surface(const std::array<Vec3d, 3>& corners, const std::array<Vec3d, 3>& normals,
                             const std::array<double, 3>& weights);

}  // namespace shlight
