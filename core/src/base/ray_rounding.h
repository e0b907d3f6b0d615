// SPDX-License-Identifier: MIT
//
// Rounding errors of rays in float.
#pragma once

#include <algorithm>
#include <cmath>

#include "shlight/types.h"

namespace shlight {

/// Largest error of a hit ÷ the largest coordinate involved: a few roundings of 2⁻²⁴ each in a ray's origin, in
/// Embree's transform of it into an instance's frame, and in its edge tests.
inline constexpr double kRayRounding = 16 * 0x1p-24;

/// Error of a hit on a mesh ÷ the mesh's extent, with room to spare.
inline constexpr double kMeshRounding = 1e-5;

/// End of a ray to a point, as a fraction of the distance: it stops a few roundings short.
inline constexpr float kRayEnd = 1.0F - 0x1p-22F;

inline double largest_component(const Vec3d& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

}  // namespace shlight
