// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "base/checks.h"
#include "shlight/types.h"

namespace shlight {

/// `direction` normalised. Throws std::invalid_argument naming the argument if it is not finite or has length 0.
inline Vec3d unit_direction(const Vec3d& direction, const char* name = "direction") {
    check_finite(name, direction);
    const double largest = std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
    if (!(largest > 0)) {
        reject(std::string(name) + " has length 0");
    }
    // Divided by the largest component first, because squares may overflow or underflow.
    return glm::normalize(direction / largest);
}

/// The angle between two directions of any length > 0, precise also where they are nearly parallel or opposite.
inline double angle_between(const Vec3d& a, const Vec3d& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

}  // namespace shlight
