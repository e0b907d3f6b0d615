// SPDX-License-Identifier: MIT
//
// Light that comes from infinitely far, from all around: of one radiance, in Blender's terms the world's background.
#pragma once

#include "shlight/types.h"

namespace shlight {

class Environment {
  public:
    Environment() = default;  ///< black
    /// The same radiance [W m⁻² sr⁻¹] from everywhere.
    /// Throws std::invalid_argument naming `radiance` if it is negative or not finite.
    explicit Environment(const Rgb& radiance);

    bool is_black() const { return constant_ == Rgb(0); }
    /// From a direction: a unit vector of the world frame that points away from the scene.
    Rgb radiance(const Vec3d& direction) const;

  private:
    Rgb constant_{0};
};

}  // namespace shlight
