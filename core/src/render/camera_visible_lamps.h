// SPDX-License-Identifier: MIT
//
// Lamps that camera rays meet.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "shlight/light.h"
#include "shlight/ray_tracer.h"
#include "shlight/types.h"

namespace shlight {

/// The lights with LightTraits::seen_by_camera.
class CameraVisibleLamps {
  public:
    CameraVisibleLamps() = default;
    /// The lights must outlive this.
    explicit CameraVisibleLamps(std::span<const Light> lights);

    bool empty() const { return lamps_.empty(); }
    /// The radiance that the lamps add to a ray, up to a surface at distance `surface`; without a surface up to t_max,
    /// and from suns. Lamps hide neither each other nor anything else. by_group: the radiance of each light group is
    /// added to it, unless it is empty.
    Rgb radiance(const Ray& ray, const std::optional<double>& surface, std::span<Rgb> by_group) const;

  private:
    std::vector<const Light*> lamps_;
};

}  // namespace shlight
