// SPDX-License-Identifier: MIT
#include <cmath>

#include "base/safe_length.h"
#include "method.h"

namespace shlight::methods {

template <class T>
CapAngles<T>::CapAngles(const CapLight& light) {
    const double length = safe_length(light.axis);
    axis = Vec3<T>(light.axis / length);
    if (light.kind == CapLight::Kind::sphere) {
        const double sine = light.size / length;
        const double cosine = std::sqrt((1 - sine) * (1 + sine));
        cos_half = static_cast<T>(cosine);
        sin_half = static_cast<T>(sine);
    } else {
        cos_half = static_cast<T>(std::cos(light.size));
        sin_half = static_cast<T>(std::sin(light.size));
    }
}

template struct CapAngles<float>;
template struct CapAngles<double>;

}  // namespace shlight::methods
