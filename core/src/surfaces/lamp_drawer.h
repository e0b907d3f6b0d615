// SPDX-License-Identifier: MIT
//
// Directions to lamps that rough interfaces let light through from. Rays that such an interface spreads meet a lamp by
// chance, and a narrow one hardly ever.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numbers>
#include <optional>

#include <glm/vec2.hpp>

#include "lights/light_sampling.h"
#include "lights/local_light.h"
#include "shlight/light.h"
#include "shlight/types.h"

namespace shlight {

/// The solid angle of a lamp [sr], about, as if it faced the point; 0 without extent.
double apparent_size(const Light& lamp, const Vec3d& from);

/// The part of a lamp's light, seen from a point in a direction, that counts where directions to the lamp are drawn;
/// the rest counts where an interface's own rays meet the lamp (the balance heuristic of Veach 1997, 9.2.2). density:
/// of these rays [1/sr], times the number of lamps if one of them is drawn.
inline double drawn_part(const Light& lamp, const Vec3d& from, double density) {
    return 1 / (1 + density * std::min(apparent_size(lamp, from), 4 * std::numbers::pi));
}

/// A drawn direction to a lamp.
struct LampDraw {
    Vec3d direction;  ///< unit, in the shading frame
    double distance;  ///< to the lamp's surface [m]; infinite for suns
    Rgb light;        ///< radiance ÷ density; of a lamp without extent its irradiance on a surface across the way
};

/// One per thread.
class LampDrawer {
  public:
    /// point: of the unit square. Returns nothing for a lamp that does not shine on the hit. error: of the hit's
    /// position [m].
    std::optional<LampDraw> draw(const Light& lamp, const ShadingFrame& frame, double error, const glm::dvec2& point);

  private:
    LocalLight local_;
    LightSampler sampler_;
};

}  // namespace shlight
