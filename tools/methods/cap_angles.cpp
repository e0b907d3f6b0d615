// SPDX-License-Identifier: MIT
#include <cmath>

#include "base/safe_length.h"
#include "method.h"

namespace shlight::methods {

template <class T>
CapAngles<T>::CapAngles(const CapLight& light) {
    const double scale = safe_scale(light.axis);
    const Vec3d scaled = light.axis * scale;
    const double length = glm::length(scaled);
    axis = Vec3<T>(scaled / length);
    if (light.kind == CapLight::Kind::sphere) {
        const double sine = light.size * scale / length;
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
