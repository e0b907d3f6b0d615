// SPDX-License-Identifier: MIT
#pragma once

#include "method.h"
#include "shlight/cap.h"

namespace shlight::methods {

/// The circle that bounds a light, in double.
inline SphericalCap circle_of(const CapLight& light) {
    if (light.kind == CapLight::Kind::sphere) {
        return cap_of_sphere(light.axis, light.size);
    }
    return cap_about_axis(light.axis, light.size);
}

}  // namespace shlight::methods
