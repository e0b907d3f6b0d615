// SPDX-License-Identifier: MIT
//
// Limits of the numbers in a scene, and checks that throw std::invalid_argument naming the argument.
// docs/conventions.md.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "base/checks.h"
#include "base/ray_rounding.h"
#include "shlight/types.h"

namespace shlight {

/// Largest coordinate and size [m]. Embree multiplies three of them in float.
inline constexpr double kFarthest = 1e10;
/// Least extent of a scene with surfaces [m]. Embree takes triangles below 1e-18 m² for points, and a scene's triangles
/// are much smaller than the scene.
inline constexpr double kLeastReach = 1e-6;
/// Largest scale of an instance; meshes with one instance have no limit.
inline constexpr double kLargestScale = 1e7;
/// Largest radiance and irradiance of lights, and largest intensity, which distances up to kFarthest reduce.
inline constexpr float kBrightest = 1e15F;
inline constexpr float kMostIntense = 1e30F;

/// Checks a number that is finite or infinite through overflow.
inline void check_reach(const std::string& name, double reach) {
    if (!(std::abs(reach) <= kFarthest)) {
        reject(name + ": a scene reaches 1e10 m from the origin at most");
    }
}

inline void check_position(const char* name, const Vec3d& position) {
    check_finite(name, position);
    check_reach(name, largest_component(position));
}

inline void check_strength(const char* name, const Rgb& strength, float largest = kBrightest) {
    check_finite(name, strength);
    if (glm::any(glm::greaterThan(glm::abs(strength), Rgb(largest)))) {
        reject(std::string(name) + " must not exceed " + (largest == kBrightest ? "1e15" : "1e30"));
    }
}

}  // namespace shlight
