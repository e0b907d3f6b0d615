// SPDX-License-Identifier: MIT
//
// An ellipse as seen from the origin: the principal axes of its cone, its boundary as elliptic functions, what the
// horizon keeps of it. In a wider type than the coefficients, as polygons are.
#pragma once

#include <optional>

#include "math/elliptic.h"
#include "regions/spherical_polygon.h"
#include "shlight/disk.h"

namespace shlight {

/// The cone of second degree about an axis. With k' = cos_long / cos_short its boundary is
///   ω(u) = sin_long sn(u) long + sin_short cn(u) short + cos_short dn(u) axis,
/// counter-clockwise about the axis, period 4K.
template <class Real>
struct Cone {
    Vec3<Real> axis, long_axis, short_axis;  ///< orthonormal, short × long = axis
    Real sin_long, cos_long;                 ///< the larger half angle
    Real sin_short, cos_short;
    Real complement;  ///< k'
};

/// A cut of a boundary by the horizon: the boundary is kept for `from` ≤ u ≤ `to`, and closed by the arc of the horizon
/// from `last`, the direction at `to`, to `first`, counter-clockwise about z by less than half a turn.
template <class Real>
struct HorizonCut {
    Real from, to;
    Vec3<Real> first, last;
    Real angle;
    /// Directions of the boundary: to the point of the ellipse that is highest above the horizon's plane, and half way
    /// from there.
    Vec3<Real> rising, highest, falling;
};

template <class Real>
class SphericalEllipse {
  public:
    /// clip: keep only z ≥ 0.
    SphericalEllipse(const Ellipse<Real>& ellipse, bool clip);

    /// Nothing is left: seen edge-on, or below the horizon.
    bool empty() const { return empty_; }
    /// These are there if it is not empty.
    const Cone<Real>& cone() const { return cone_; }
    const std::optional<HorizonCut<Real>>& cut() const { return cut_; }
    const EllipticFunctions<Real>& functions() const { return *functions_; }
    /// The boundary's direction at u, a unit vector.
    Vec3<Real> direction(Real u) const;
    /// Between a third of what is kept and all of it: of a polygon on its boundary.
    Real least_solid_angle() const { return least_solid_angle_; }
    /// About the length of the boundary of what is kept.
    Real boundary() const { return boundary_; }

  private:
    void cut_by_horizon(const Ellipse<Real>& given, const Ellipse<Real>& principal);
    void measure();

    bool empty_ = true;
    Cone<Real> cone_{};
    std::optional<HorizonCut<Real>> cut_;
    std::optional<EllipticFunctions<Real>> functions_;
    Real least_solid_angle_ = 0, boundary_ = 0;
};

/// How the origin lies to an ellipse.
enum class OriginPlace { beside_plane, in_plane_outside, in_plane_inside };
template <class Real>
OriginPlace place_of_origin(const Ellipse<Real>& ellipse);

}  // namespace shlight
