// SPDX-License-Identifier: MIT
//
// Directions without extent, many of them, as a lobe reflects them: in lanes, one for each direction.
#pragma once

#include <span>
#include <vector>

#include <glm/mat3x3.hpp>

#include "environment/environment_map.h"
#include "shlight/lobe_shape.h"

namespace shlight {

class BrightSpots {
  public:
    explicit BrightSpots(std::span<const BrightSpot> spots);

    /// Radiance that a lobe reflects of the spots. to_map: rotation from the shading frame to the spots' frame.
    /// Precondition: no mirror; the lobe's squared width is in a float's range.
    Rgb reflected(const LobeShape& shape, double cos_theta_o, const glm::dmat3& to_map) const;

    struct Arrays {
        const float *x, *y, *z, *r, *g, *b;
        std::size_t count;  // with what fills the last vector up, which shines nowhere
    };

  private:
    std::vector<float> x_, y_, z_, r_, g_, b_;
};

}  // namespace shlight
