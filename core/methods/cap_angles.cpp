// SPDX-License-Identifier: MIT
#include <cmath>

#include "method.h"

namespace shlight::methods {

template <class T>
CapAngles<T>::CapAngles(const CapLight& light) {
    const double length = std::hypot(std::hypot(light.axis.x, light.axis.y), light.axis.z);
    axis = Vec3<T>(light.axis / length);
    if (light.kind == CapLight::Kind::sphere) {
        const double sine = light.size / length;
        const double cosine = std::sqrt((1 - sine) * (1 + sine));
        half_angle = static_cast<T>(std::atan2(sine, cosine));
        cos_half = static_cast<T>(cosine);
        sin_half = static_cast<T>(sine);
    } else {
        half_angle = static_cast<T>(light.size);
        cos_half = static_cast<T>(std::cos(light.size));
        sin_half = static_cast<T>(std::sin(light.size));
    }
}

template struct CapAngles<float>;
template struct CapAngles<double>;

}  // namespace shlight::methods
