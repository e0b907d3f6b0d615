// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

#include "shlight/types.h"

namespace shlight {

/// A unit vector perpendicular to a unit axis; a deterministic choice.
inline Vec3d perpendicular(const Vec3d& axis) {
    return glm::normalize(glm::cross(std::abs(axis.z) < 0.9 ? Vec3d(0, 0, 1) : Vec3d(1, 0, 0), axis));
}

}  // namespace shlight
