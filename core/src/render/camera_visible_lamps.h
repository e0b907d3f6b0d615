// SPDX-License-Identifier: MIT
//
// Lamps where the camera looks at them.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "shlight/light.h"
#include "shlight/ray_tracer.h"
#include "shlight/types.h"

namespace shlight {

/// Those lights that the camera sees (LightTraits::seen_by_camera).
class CameraVisibleLamps {
  public:
    CameraVisibleLamps() = default;
    /// The lights must outlive this.
    explicit CameraVisibleLamps(std::span<const Light> lights);

    bool empty() const { return lamps_.empty(); }
    /// What they add to the radiance that comes back along a ray from its start to a surface at distance `surface`;
    /// nothing there: to t_max, and to suns behind it. They hide neither each other nor what is behind them.
    /// by_group: is added to what each group of lamps adds, unless it is empty.
    Rgb radiance(const Ray& ray, const std::optional<double>& surface, std::span<Rgb> by_group) const;

  private:
    std::vector<const Light*> lamps_;
};

}  // namespace shlight
