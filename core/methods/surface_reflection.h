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

/// A material at one view. Keeps its memory from one to the next.
class SurfaceReflection {
  public:
    void reset(const Bsdf& bsdf, float cos_theta_o);

    const Vec3d& view() const { return view_; }
    /// f·cos of all lobes but mirrors, in the shading frame, or of diffuse or glossy ones alone.
    Rgb value(const Vec3d& direction, bool diffuse = true, bool glossy = true) const;
    /// A lobe that is no mirror by chance, in proportion to what it reflects of a white sky, and a direction as it
    /// reflects. Density 0 for a direction below the horizon, and where there are mirrors only. choice: in (0, 1).
    RandomDirection sample(double choice, const glm::dvec2& point) const;
    double density(const Vec3d& direction) const;
    /// What mirrors reflect of the direction (-view.x, 0, view.z).
    const Rgb& mirrored() const { return mirrored_; }

  private:
    struct Part {
        LobeShape shape;
        Rgb scale;
        double albedo;  // of the largest channel
    };

    Vec3d view_{0, 0, 1};
    Rgb mirrored_{0};
    double albedo_ = 0;
    std::vector<Part> parts_;
};

}  // namespace shlight::methods
