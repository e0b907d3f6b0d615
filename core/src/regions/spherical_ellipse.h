// SPDX-License-Identifier: MIT
//
// An ellipse as seen from the origin: the principal axes of its cone, its boundary as elliptic functions, what the
// horizon keeps of it.
#pragma once

#include <optional>

#include "math/elliptic.h"
#include "regions/spherical_polygon.h"
#include "shlight/disk.h"

namespace shlight {

/// The cone of second degree about an axis. With k' = cos_long / cos_short its boundary is
///   ω(u) = sin_long sn(u) long + sin_short cn(u) short + cos_short dn(u) axis,
/// counter-clockwise about the axis, period 4K.
struct Cone {
    Vec3d axis, long_axis, short_axis;  ///< orthonormal, short × long = axis
    double sin_long, cos_long;          ///< the larger half angle
    double sin_short, cos_short;
    double complement;  ///< k'
};

/// A cut of a boundary by the horizon: the boundary is kept for `from` ≤ u ≤ `to`, and closed by the arc of the horizon
/// from `last`, the direction at `to`, to `first`, counter-clockwise about z by less than half a turn.
struct HorizonCut {
    double from, to;
    Vec3d first, last;
    double angle;
    /// Directions of the boundary: to the point of the ellipse that is highest above the horizon's plane, and half way
    /// from there.
    Vec3d rising, highest, falling;
    /// The boundary's z is rise (cos δ - cos reach) dn(u), δ the angle from the highest point as a parameter of the
    /// ellipse.
    double rise, reach, cos_highest, sin_highest;
};

/// The middle of the arc of the horizon.
Vec3d horizon_middle(const HorizonCut& cut);

class SphericalEllipse {
  public:
    /// clip: keep only z ≥ 0.
    SphericalEllipse(const Ellipse& ellipse, bool clip);

    /// Nothing is left: seen edge-on, or below the horizon.
    bool empty() const { return empty_; }
    /// These are there if it is not empty.
    const Cone& cone() const { return cone_; }
    const std::optional<HorizonCut>& cut() const { return cut_; }
    const EllipticFunctions& functions() const { return *functions_; }
    /// The boundary's direction at u, a unit vector.
    Vec3d direction(double u) const;
    /// Its z where functions() have these values, to a rounding however low the cut by the horizon leaves it.
    /// Precondition: cut().
    double height(const EllipticFunctions::Values& f) const;
    /// Between a third of what is kept and all of it: of a polygon on its boundary.
    double least_solid_angle() const { return least_solid_angle_; }
    /// About the length of the boundary of what is kept.
    double boundary() const { return boundary_; }

  private:
    /// scale: 1 ÷ the distance of the short axis' ends.
    void cut_by_horizon(const Ellipse& given, const Ellipse& principal, double scale);
    void measure();

    bool empty_ = true;
    Cone cone_{};
    std::optional<HorizonCut> cut_;
    std::optional<EllipticFunctions> functions_;
    double least_solid_angle_ = 0, boundary_ = 0;
};

/// How the origin lies to an ellipse.
enum class OriginPlace { beside_plane, in_plane_outside, in_plane_inside };
OriginPlace place_of_origin(const Ellipse& ellipse);

}  // namespace shlight
