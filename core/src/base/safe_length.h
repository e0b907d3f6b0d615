// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>

#include "shlight/types.h"

namespace shlight {

/// Whether a square is in the range where no relevant difference underflows and no sum of a few squares overflows.
inline bool is_safe_square(double square) {
    return square > 1e-280 && square < 1e280;
}

/// |v| without overflow or underflow; std::hypot takes several times as long.
inline double safe_length(const Vec3d& v) {
    const double square = glm::dot(v, v);
    return is_safe_square(square) ? std::sqrt(square) : std::hypot(v.x, v.y, v.z);
}

/// The power of two that brings a number, finite and not negative, to 1 … 2, or closer to it; 1 for 0.
inline double power_of_two_scale(double largest) {
    // Clamped because the reciprocals of the extreme doubles overflow or are subnormal.
    return largest > 0 ? std::ldexp(1.0, -std::clamp(std::ilogb(largest), -1022, 1022)) : 1.0;
}

/// The power of two that makes the square of the finite vector v safe; 1 if it is safe, or if v is 0.
inline double safe_scale(const Vec3d& v) {
    if (is_safe_square(glm::dot(v, v))) {
        return 1;
    }
    return power_of_two_scale(std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}));
}

}  // namespace shlight
