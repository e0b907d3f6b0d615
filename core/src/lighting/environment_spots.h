// SPDX-License-Identifier: MIT
//
// The bright spots of a picture around a scene, as lobes reflect them: each from one direction, or, beside the peak of
// a lobe that changes over a texel, from many.
#pragma once

#include <array>
#include <vector>

#include "environment/environment_map.h"
#include "shlight/lobe_shape.h"
#include "shlight/types.h"

namespace shlight {

class EnvironmentSpots {
  public:
    /// map: must outlive this.
    explicit EnvironmentSpots(const EnvironmentMap& map);

    /// Radiance that a lobe reflects of all spots. to_map: from the shading frame to the picture; view: unit, there.
    Rgb reflected(const LobeShape& shape, const glm::dmat3& to_map, const Vec3d& view) const;

  private:
    /// Directions' x, y and z, and irradiance in three channels, padded for lanes.
    using Arrays = std::array<std::vector<float>, 6>;

    /// Adds a spot from `across` directions along each side of the two texels that its light is interpolated over. One,
    /// or an even number: the shares of an odd one would not add up to 1.
    void add(const BrightSpot& spot, int across, Arrays& spots) const;
    /// The reflected share of the irradiance from each direction.
    static std::vector<float> weigh(const Arrays& spots, const LobeShape& shape, const glm::dmat3& to_map,
                                    const Vec3d& view);

    const EnvironmentMap* map_;
    Arrays spots_;  // one direction each
};

}  // namespace shlight
