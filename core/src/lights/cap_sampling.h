// SPDX-License-Identifier: MIT
//
// Directions to a sphere or a facing disk; light_sampling.h says what samplers do.
#pragma once

#include <optional>

#include <glm/vec2.hpp>

#include "lights/local_light.h"
#include "math/light_sample.h"
#include "shlight/types.h"

namespace shlight {

/// Samples uniform in the solid angle of a cap. Along a meridian that the horizon cuts they are uniform in the part
/// above it.
class CapSampler {
  public:
    explicit CapSampler(const CapView& cap);
    LightSample sample(const glm::dvec2& point) const;
    /// Solid angle of the part above the horizon.
    double solid_angle() const;
    /// Distance to the light's surface along a unit direction above the horizon; nothing if it misses the light.
    std::optional<double> meets(const Vec3d& direction) const;

  private:
    double distance(const Vec3d& direction, double cosine) const;  // to the light's surface

    CapView cap_;
    double distance_;                    // to the centre
    Vec3d axis_, up_, across_;           // up: at right angles to the axis, towards the zenith
    double axis_height_ = 1, tilt_ = 0;  // the axis' elevation: sine and cosine
    double one_minus_cos_ = 1;           // 1 - cos of the half angle
    double sine_ = 1;                    // sine of the half angle
    bool cut_ = false;                   // whether the horizon cuts the cap
    double widest_;                      // azimuth about the axis, from `up`, where the light ends
};

}  // namespace shlight
