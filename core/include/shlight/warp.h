// SPDX-License-Identifier: MIT
//
// A conformal warp of the sphere of directions: a boost that spreads a narrow lobe until few bands describe it.
//
// A Möbius map of the sphere, the aberration of a moving observer: circles stay circles, so the cap of a sphere light,
// the horizon, and the edges of a polygon keep exact coefficients in warped space. docs/theory.md, 6.1, derives it.
#pragma once

#include "shlight/types.h"

namespace shlight {

/// A circle on the unit sphere, with the cap {ω : ω·axis ≥ cosine} on one side of it.
struct Circle {
    Vec3d axis;     ///< unit
    double cosine;  ///< of the half angle, which may be anything in 0 … π
    double sine;    ///< ≥ 0; given beside the cosine because small caps need it
};

/// The circle inside which a sphere is seen from the origin; precondition 0 < radius ≤ |center|, all finite.
/// |c|² - r² by exact products: near contact it is a small difference of the inputs.
Circle circle_of_sphere(const Vec3d& center, double radius);
/// The same of a disk that always faces the origin: half angle atan(radius / |center|); center ≠ 0.
Circle circle_of_facing_disk(const Vec3d& center, double radius);
/// The circle of a half angle [rad] about an axis of any length > 0; 0 < half_angle, more than π counts as π.
Circle circle_about_axis(const Vec3d& axis, double half_angle);

/// Directions ω of the shading frame ↔ warped directions u, in a frame whose z axis is the middle of the warped
/// horizon: the upper hemisphere becomes the cap u_z ≥ horizon_height(). The plane y = 0 stays the plane y = 0.
class Warp {
  public:
    /// No warp: u = ω.
    Warp() = default;
    /// The neighbourhood of the axis (-sin tilt, 0, cos tilt) is enlarged by (1 + r) / (1 - r), r = 1 - narrowness.
    /// Precondition: |tilt| < π/2 [rad], 0 < narrowness ≤ 1.
    Warp(double tilt, double narrowness);

    double horizon_height() const { return horizon_height_; }  ///< z_0 = u_z along the horizon
    double horizon_sine() const { return horizon_sine_; }      ///< √(1 - z_0²)

    /// ω unit.
    Vec3d warped(const Vec3d& direction) const;
    /// The inverse; u unit.
    Vec3d direction(const Vec3d& warped) const;
    /// dω/du at u, as areas.
    double density(const Vec3d& warped) const;

  private:
    Vec3d axis() const { return {-sin_tilt_, 0, cos_tilt_}; }

    double sin_tilt_ = 0, cos_tilt_ = 1;
    double speed_ = 0;                      // b = 2r / (1 + r²)
    double one_minus_speed_ = 1;            // 1 - b = (1-r)² / (1+r²)
    double gamma_ = 1;                      // 1 / √(1 - b²)
    double horizon_x_ = 0, horizon_z_ = 1;  // the warped horizon's middle in the boost's frame
    double horizon_height_ = 0, horizon_sine_ = 1;
};

}  // namespace shlight
