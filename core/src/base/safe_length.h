// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

#include "shlight/types.h"

namespace shlight {

/// |v| without overflow or underflow; std::hypot takes several times as long.
inline double safe_length(const Vec3d& v) {
    const double square = glm::dot(v, v);
    return square > 1e-280 && square < 1e280 ? std::sqrt(square) : std::hypot(v.x, v.y, v.z);
}

}  // namespace shlight
