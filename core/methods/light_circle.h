// SPDX-License-Identifier: MIT
#pragma once

#include "method.h"
#include "shlight/warp.h"

namespace shlight::methods {

/// The circle that bounds a light, in double.
inline Circle circle_of(const CapLight& light) {
    if (light.kind == CapLight::Kind::sphere) {
        return circle_of_sphere(light.axis, light.size);
    }
    return circle_about_axis(light.axis, light.size);
}

}  // namespace shlight::methods
