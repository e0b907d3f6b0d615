// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "method.h"
#include "shlight/warp.h"

namespace shlight::methods {

/// The circle that bounds a light, in double.
inline Circle circle_of(const CapLight& light) {
    if (light.kind == CapLight::Kind::sphere) {
        return circle_of_sphere(light.axis, light.size);
    }
    const double half_angle = std::min(light.size, std::numbers::pi);
    const double length = std::hypot(light.axis.x, light.axis.y, light.axis.z);
    return {light.axis / length, std::cos(half_angle), std::sin(half_angle)};
}

}  // namespace shlight::methods
