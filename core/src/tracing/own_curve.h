// SPDX-License-Identifier: MIT
//
// Shadow rays from curves and spheres. Their Terminator lifts no rays; its `lift` is the way from the middle of the
// curve or sphere to where it is lit.
#pragma once

#include "tracing/terminator.h"

namespace shlight {

/// The beginning of a ray from a hit, as a share of its way of any length: beside the middle of the hit's own curve,
/// which faces the ray if it is a ribbon, and does not shade itself there, as in Cycles.
inline float begin_beside_curve(const Terminator& own, const Vec3f& way) {
    constexpr double kBeside = 1 + 1e-4;
    const double along = own.lifts() ? 0.0 : -glm::dot(own.lift, Vec3d(way));
    return along > 0 ? static_cast<float>(along / glm::dot(Vec3d(way), Vec3d(way)) * kBeside) : 0.0F;
}

}  // namespace shlight
