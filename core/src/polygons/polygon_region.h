// SPDX-License-Identifier: MIT
//
// A polygon's image under a warp: a region of the sphere that is bounded by circular arcs. Without a warp the arcs are
// the polygon's own great-circle edges (docs/algorithms.md, "Regions bounded by circular arcs").
#pragma once

#include <array>
#include <vector>

#include "polygons/spherical_polygon.h"
#include "shlight/warp.h"

namespace shlight {

/// An arc of the circle {u : u·axis = cosine}, run through counter-clockwise about the axis.
template <class Real>
struct Arc {
    Vec3<Real> axis;    ///< unit
    Real cosine, sine;  ///< of the circle's half angle; sine > 0
    Real angle;         ///< about the axis, in 0 … 2π
    Vec3<Real> from, to;
};

template <class Real>
class PolygonRegion {
  public:
    /// The image of a polygon that was clipped by the *true* horizon; edges in the horizon become arcs of its image.
    PolygonRegion(const SphericalPolygon<Real>& polygon, const Warp& warp);

    /// The interior, u·axis > cosine, on the left. Edges without length are left out.
    const std::vector<Arc<Real>>& arcs() const { return arcs_; }
    /// Of the image; about 1e-16 · (number of edges) wrong, less for a small image. What the coefficients lose to
    /// cancellation follows from it, see polygon.h.
    Real solid_angle() const { return solid_angle_; }
    /// Length of all arcs.
    Real outline() const;
    /// Bands 0 and 1 in closed form, at their indices: the solid angle and the vector irradiance,
    ///   ∫ u du = ½ Σ [ s² ψ L + c L × (to - from) ]   (Lambert 1760 for c = 0).
    /// In the wider type the cancellation of an unwarped polygon's edges leaves every digit of T.
    std::array<Real, 4> low_bands() const;

  private:
    std::vector<Arc<Real>> arcs_;
    Real solid_angle_ = 0;
};

}  // namespace shlight
