// SPDX-License-Identifier: MIT
//
// A whole material for a Monte Carlo renderer: values and random directions of all its lobes together.
#pragma once

#include <vector>

#include <glm/vec2.hpp>

#include "random_directions.h"
#include "shlight/bsdf.h"
#include "shlight/types.h"

namespace shlight::methods {

/// A material at one view. Memory is reused from view to view.
class SurfaceReflection {
  public:
    /// azimuth: of the view from the surface's tangent on.
    void reset(const Bsdf& bsdf, float cos_theta_o, double azimuth);

    const Vec3d& view() const { return view_; }
    /// f·cos in the shading frame of all lobes except mirrors, or of the diffuse or glossy ones only.
    Rgb value(const Vec3d& direction, bool diffuse = true, bool glossy = true) const;
    /// Picks a lobe, not a mirror, with probability proportional to its albedo, and samples it. The density is 0 for a
    /// direction below the horizon, and if there are only mirrors. choice: in (0, 1).
    RandomDirection sample(double choice, const glm::dvec2& point) const;
    double density(const Vec3d& direction) const;
    /// Weight of mirrors, which reflect the direction (-view.x, 0, view.z).
    const Rgb& mirrored() const { return mirrored_; }

  private:
    struct Part {
        LobeShape shape;
        Rgb scale;
        double albedo;  // in the largest channel
    };

    Vec3d view_{0, 0, 1};
    Rgb mirrored_{0};
    double albedo_ = 0;
    std::vector<Part> parts_;
};

}  // namespace shlight::methods
