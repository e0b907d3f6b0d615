// SPDX-License-Identifier: MIT
//
// What the horizon keeps of a light, cut into patches on which product rules converge fast.
//
// A patch is swept by spokes: arcs of great circles from a hub to the light's outline. Azimuths about the hub count by
// the direction in which the outline runs, so that the patches of a closed outline add up to what it encloses wherever
// the hub lies. Seen from a hub inside, rings of a cap are whole, and the horizon is one smooth edge among others.
#pragma once

#include <vector>

#include "polygons/spherical_polygon.h"
#include "shlight/types.h"
#include "shlight/warp.h"

namespace shlight::methods {

/// Part of an outline: the directions to base + offset + f(t), t = from … to, where f is a circle's cos t · x + sin t ·
/// y, or t · x for an arc of a great circle. The base is common to a region, so that a small one keeps its digits.
struct Edge {
    bool straight;
    Vec3d offset, x, y;
    double from, to;
};

/// An arc from a patch's hub to its edge.
struct Spoke {
    Vec3d across;  ///< unit, at right angles to the hub: where the spoke leaves for
    double reach;  ///< length [rad]; magnified, see Patch
    double turn;   ///< signed azimuth about the hub per unit of v
};

struct WeightedDirection {
    Vec3d direction;  ///< unit
    double weight;    ///< solid angle per du dv, signed
};

/// The unit square u, v: v along the edge, u from the hub to it. The angle from the hub is proportional to u, or with a
/// magnification k that angle after tan(angle / 2) has grown k times, which spreads what is narrow about the hub.
class Patch {
  public:
    Patch(const Vec3d& hub, double magnification, const Vec3d& base, const Edge& edge);
    /// A whole cap about its own axis: v goes all around.
    explicit Patch(const Circle& cap);

    bool goes_around() const { return whole_; }
    Spoke spoke(double v) const;
    WeightedDirection at(const Spoke& spoke, double u) const;
    /// The same with its weights negated.
    Patch negative() const;

  private:
    Vec3d hub_;
    double magnification_ = 1, sign_ = 1;
    bool whole_;
    double half_angle_ = 0;  // of a whole cap
    Vec3d offset_{0};        // from the hub to the edge's base and offset
    Edge edge_;
};

class KeptRegion {
  public:
    /// A cap of any half angle; clip: keep z ≥ 0.
    static KeptRegion of_cap(const Circle& cap, bool clip);
    /// A polygon that was clipped before, or not.
    static KeptRegion of_polygon(const SphericalPolygon& polygon);

    bool empty() const { return edges_.empty() && caps_.empty(); }
    /// Inside, where the region is convex.
    const Vec3d& middle() const { return base_; }
    /// The largest angle between the middle and the outline; of a region that has one outline.
    double extent() const;
    /// Whole caps about their axes, all else about the middle.
    std::vector<Patch> patches() const;
    /// All about one hub, anywhere above the horizon. Precondition: no half angle above π/2.
    std::vector<Patch> patches_about(const Vec3d& hub, double magnification) const;

  private:
    struct WholeCap {
        Circle circle;
        double sign;
    };
    void add_cap(const Circle& cap, double sign);
    void add_cut_cap(const Circle& cap, double sign);

    Vec3d base_{0, 0, 1};
    std::vector<Edge> edges_;
    double edge_sign_ = 1;
    std::vector<WholeCap> caps_;
};

}  // namespace shlight::methods
