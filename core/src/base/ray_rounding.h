// SPDX-License-Identifier: MIT
//
// How far rays in float may miss a surface.
#pragma once

#include <algorithm>
#include <cmath>

#include "shlight/types.h"

namespace shlight {

/// In units of the largest coordinate involved: a few roundings of 2⁻²⁴ each in a ray's origin, in Embree's transform
/// of it into an instance's frame, and in its edge tests.
inline constexpr double kRayRounding = 16 * 0x1p-24;

/// Where a ray to a point ends, as part of the way: all but the last few roundings.
inline constexpr float kRayEnd = 1.0F - 0x1p-22F;

inline double largest_component(const Vec3d& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

}  // namespace shlight
