// SPDX-License-Identifier: MIT
//
// Light that comes from infinitely far, from all around: of one radiance, or as a picture has it. In Blender's terms
// the world's background, of a colour or an environment texture.
#pragma once

#include <memory>
#include <vector>

#include <glm/mat3x3.hpp>

#include "shlight/parallel.h"
#include "shlight/types.h"

namespace shlight {

/// A picture of all directions in equal steps of latitude and longitude, mapped as Blender maps equirectangular ones:
/// row 0 lies around +z, the last row around -z; columns go from -x over +y, +x (the picture's middle) and -y back to
/// -x. Between the centres of texels radiance is bilinear; it is constant from the outermost rows' centres to the
/// poles.
struct LatLong {
    std::vector<Rgb> pixels;  ///< row by row, radiance [W m⁻² sr⁻¹]
    int width = 0, height = 0;
    glm::dmat3 to_world{1};  ///< a rotation
};

class Environment {
  public:
    Environment() = default;  ///< black
    /// The same radiance [W m⁻² sr⁻¹] from everywhere.
    /// Throws std::invalid_argument naming the argument `name` if it is negative or not finite.
    explicit Environment(const Rgb& radiance, const char* name = "radiance");
    /// Throws std::invalid_argument naming the argument `name` if there are no pixels, not as many as the size says,
    /// more than 2^28, or any that is negative, not finite or above 1e15, and naming `to_world` if that is not a
    /// rotation.
    explicit Environment(LatLong picture, const char* name = "radiance");

    bool is_black() const;
    /// The same radiance, or the same picture in memory.
    bool operator==(const Environment&) const = default;
    /// direction: a unit vector of the world frame that points away from the scene.
    Rgb radiance(const Vec3d& direction) const;
    /// This environment with map(), which takes seconds for a large picture. before: an environment that may have the
    /// map already. Throws RenderCancelled once it is to end.
    Environment prepared(const Environment& before, const Stopped& stopped) const;
    /// The data for lighting by the picture; null before prepared() and for an environment of one radiance.
    const struct EnvironmentMap* map() const { return map_.get(); }

  private:
    Rgb constant_{0};
    std::shared_ptr<const LatLong> picture_;  // null: one radiance comes from everywhere
    std::shared_ptr<const EnvironmentMap> map_;
};

}  // namespace shlight
