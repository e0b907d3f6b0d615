// SPDX-License-Identifier: MIT
//
// Directions to a sphere or a facing disk, as light_sampling.h describes samplers.
#pragma once

#include <optional>

#include <glm/vec2.hpp>

#include "lights/seen_light.h"
#include "math/light_sample.h"
#include "shlight/types.h"

namespace shlight {

/// Uniform in the solid angle of a cap; along each meridian that the horizon cuts, uniform in what is left of it.
class CapSampler {
  public:
    explicit CapSampler(const CapView& cap);
    LightSample sample(const glm::dvec2& point) const;
    /// Above the horizon.
    double solid_angle() const;
    /// To the light's surface along a unit direction above the horizon; nothing where it misses.
    std::optional<double> meets(const Vec3d& direction) const;

  private:
    double distance(const Vec3d& direction, double cosine) const;  // to the light's surface

    CapView cap_;
    double distance_;                    // of the centre
    Vec3d axis_, up_, across_;           // up: at right angles to the axis, towards the zenith
    double axis_height_ = 1, tilt_ = 0;  // the axis' elevation: sine and cosine
    double one_minus_cos_ = 1;           // of the half angle
    double sine_ = 1;                    // likewise
    bool cut_ = false;                   // by the horizon
    double widest_;                      // azimuth about the axis, from `up`, where the light ends
};

}  // namespace shlight
