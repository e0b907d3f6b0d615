// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>

#include "shlight/types.h"

namespace shlight {

/// Of squares in this range no difference that matters underflows, and no sum of a few overflows.
inline bool is_safe_square(double square) {
    return square > 1e-280 && square < 1e280;
}

/// |v| without overflow or underflow; std::hypot takes several times as long.
inline double safe_length(const Vec3d& v) {
    const double square = glm::dot(v, v);
    return is_safe_square(square) ? std::sqrt(square) : std::hypot(v.x, v.y, v.z);
}

/// The power of two by which v, finite, is to be multiplied for its square to be safe; 1 if it is, or if v is 0.
inline double safe_scale(const Vec3d& v) {
    if (is_safe_square(glm::dot(v, v))) {
        return 1;
    }
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    // The inverse of the least and of the largest doubles is none, or none in full precision.
    return largest > 0 ? std::ldexp(1.0, -std::clamp(std::ilogb(largest), -1022, 1022)) : 1.0;
}

}  // namespace shlight
