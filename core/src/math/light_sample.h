// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>

#include "shlight/types.h"

namespace shlight {

struct LightSample {
    Vec3d direction;  ///< unit, in the shading frame
    double distance;  ///< to the light's surface
    double weight;
};

}  // namespace shlight
