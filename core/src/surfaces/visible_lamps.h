// SPDX-License-Identifier: MIT
//
// Lamps that rays meet. Surfaces that shine are met as surfaces.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "shlight/light.h"
#include "shlight/ray_tracer.h"
#include "shlight/scene.h"
#include "shlight/types.h"

namespace shlight {

class VisibleLamps {
  public:
    VisibleLamps() = default;
    /// Keeps pointers to the lights that a viewer sees.
    VisibleLamps(std::span<const Light> lights, LampViewer viewer);

    bool empty() const { return lamps_.empty(); }
    /// The radiance that the lamps add to a ray, up to a surface at distance `surface`; without a surface up to t_max,
    /// and from suns. Lamps hide neither each other nor anything else. light_set: others do not show it; none: all do.
    /// by_group: the radiance of each light group is added to it, unless it is empty. density: of the ray's
    /// direction, where a part of the lamps is drawn, see drawn_part(); infinite: nothing is.
    Rgb radiance(const Ray& ray, const std::optional<double>& surface,
                 const std::optional<std::uint32_t>& light_set = std::nullopt, std::span<Rgb> by_group = {},
                 double density = std::numeric_limits<double>::infinity()) const;

  private:
    std::vector<const Light*> lamps_;
};

}  // namespace shlight
