// SPDX-License-Identifier: MIT
//
// The part of a light above the horizon, cut into patches on which product rules converge fast.
//
// A patch is swept by spokes: arcs of great circles from a hub to the light's boundary. Azimuths about the hub are
// signed by the direction of the boundary, so that the patches of a closed boundary add up to its interior for any hub.
// With a hub inside, rings of a cap are complete, and the horizon is one smooth edge.
#pragma once

#include <vector>

#include "regions/spherical_polygon.h"
#include "shlight/cap.h"
#include "shlight/types.h"

namespace shlight::methods {

/// Part of a boundary: the directions of base + offset + f(t), t = from … to, where f is cos t · x + sin t · y on a
/// circle, or t · x on an arc of a great circle. A region has one base, so that small regions keep their digits.
struct Edge {
    bool straight;
    Vec3d offset, x, y;
    double from, to;
};

/// An arc from a patch's hub to its edge.
struct Spoke {
    Vec3d across;  ///< unit, perpendicular to the hub: direction in which the spoke starts
    double reach;  ///< length [rad]; magnified, see Patch
    double turn;   ///< signed azimuth about the hub per unit of v
};

struct WeightedDirection {
    Vec3d direction;  ///< unit
    double weight;    ///< solid angle per du dv, signed
};

/// The unit square u, v, with v along the edge and u from the hub to it. The angle from the hub is proportional to u;
/// with a magnification k, 2 atan(k tan(angle/2)) is, which widens narrow features at the hub.
class Patch {
  public:
    Patch(const Vec3d& hub, double magnification, const Vec3d& base, const Edge& edge);
    /// A whole cap about its axis: v goes around once.
    explicit Patch(const SphericalCap& cap);

    bool goes_around() const { return whole_; }
    Spoke spoke(double v) const;
    WeightedDirection at(const Spoke& spoke, double u) const;
    /// The patch with negated weights.
    Patch negative() const;

  private:
    Vec3d hub_;
    double magnification_ = 1, sign_ = 1;
    bool whole_;
    double half_angle_ = 0;  // used for a whole cap
    Vec3d offset_{0};        // from the hub to the edge's base and offset
    Edge edge_;
};

class KeptRegion {
  public:
    /// A cap of any half angle; clip: keep z ≥ 0.
    static KeptRegion of_cap(const SphericalCap& cap, bool clip);
    /// A polygon, clipped by the caller or not.
    static KeptRegion of_polygon(const SphericalPolygon& polygon);

    bool empty() const { return edges_.empty() && caps_.empty(); }
    /// A direction in the middle, which is inside if the region is convex.
    const Vec3d& middle() const { return base_; }
    /// The largest angle between the middle and the boundary, for a region with one boundary.
    double extent() const;
    /// Patches of whole caps about their axes, and of other regions about the middle.
    std::vector<Patch> patches() const;
    /// Patches about a hub anywhere above the horizon. Precondition: no half angle above π/2.
    std::vector<Patch> patches_about(const Vec3d& hub, double magnification) const;

  private:
    struct WholeCap {
        SphericalCap circle;
        double sign;
    };
    void add_cap(const SphericalCap& cap, double sign);
    void add_cut_cap(const SphericalCap& cap, double sign);

    Vec3d base_{0, 0, 1};
    std::vector<Edge> edges_;
    double edge_sign_ = 1;
    std::vector<WholeCap> caps_;
};

}  // namespace shlight::methods
