// SPDX-License-Identifier: MIT
#include "shlight/environment.h"

#include <cmath>

#include "checks.h"

namespace shlight {

Environment::Environment(const Rgb& radiance) : constant_(radiance) {
    check_finite("radiance", radiance);
    if (glm::any(glm::lessThan(radiance, Rgb(0)))) {
        reject("radiance must not be negative");
    }
}

Rgb Environment::radiance(const Vec3d& /*direction*/) const {
    return constant_;
}

}  // namespace shlight
