// SPDX-License-Identifier: MIT
//
// A boost of the sphere of directions, which spreads a narrow lobe until few bands describe it.
//
// A Möbius map of the sphere, the aberration of a moving observer: circles stay circles, so the cap of a sphere light,
// the horizon, and the edges of a polygon keep exact coefficients in the boosted frame. docs/theory.md, 6.1, derives
// it.
#pragma once

#include "shlight/types.h"

namespace shlight {

/// Directions ω of the shading frame ↔ boosted directions u, in a frame whose z axis is the middle of the boosted
/// horizon: the upper hemisphere becomes the cap u_z ≥ horizon_height(). The plane y = 0 stays the plane y = 0.
class Boost {
  public:
    /// No boost: u = ω.
    Boost() = default;
    /// The neighbourhood of the axis (-sin tilt, 0, cos tilt) is enlarged by (1 + r) / (1 - r), r = 1 - narrowness.
    /// Precondition: |tilt| < π/2 [rad], 0 < narrowness ≤ 1.
    Boost(double tilt, double narrowness);

    double horizon_height() const { return horizon_height_; }  ///< z_0 = u_z along the horizon
    double horizon_sine() const { return horizon_sine_; }      ///< √(1 - z_0²)

    /// ω unit.
    Vec3d boosted(const Vec3d& direction) const;
    /// The inverse; u unit.
    Vec3d direction(const Vec3d& boosted) const;
    /// dω/du at u, as areas.
    double density(const Vec3d& boosted) const;

  private:
    Vec3d axis() const { return {-sin_tilt_, 0, cos_tilt_}; }

    double sin_tilt_ = 0, cos_tilt_ = 1;
    double speed_ = 0;                      // b = 2r / (1 + r²)
    double one_minus_speed_ = 1;            // 1 - b = (1-r)² / (1+r²)
    double gamma_ = 1;                      // 1 / √(1 - b²)
    double horizon_x_ = 0, horizon_z_ = 1;  // the boosted horizon's middle in the boost's frame
    double horizon_height_ = 0, horizon_sine_ = 1;
};

}  // namespace shlight
