// SPDX-License-Identifier: MIT
//
// What numbers a scene may hold: checks that throw std::invalid_argument naming the argument. docs/conventions.md.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "base/checks.h"
#include "base/ray_rounding.h"
#include "shlight/types.h"

namespace shlight {

/// [m]: of coordinates and sizes. Embree multiplies three of them in float.
inline constexpr double kFarthest = 1e10;
/// [m]: what a scene with surfaces must reach. Embree takes triangles of less than 1e-18 m² for points, and a scene is
/// cut into many that are smaller than it.
inline constexpr double kLeastReach = 1e-6;
/// Of instances, of which a mesh has more than one.
inline constexpr double kLargestScale = 1e7;
/// Radiance and irradiance of lights, and intensity, which distances up to kFarthest weaken.
inline constexpr float kBrightest = 1e15F;
inline constexpr float kMostIntense = 1e30F;

/// Of one number that is known to be finite, or what is left of overflow.
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
