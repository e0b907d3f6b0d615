// SPDX-License-Identifier: MIT
//
// Lights that do not shine evenly: the mean of their emission profile, as a lobe weighs the light.
//
// Radiance of an even light, which is exact, times Σ w L f / Σ w f over nodes that fill the light, L the profile's
// factor, f the lobe's f·cos. What the rule gets wrong of a narrow lobe it gets wrong in both sums. Nodes are those of
// rings (profile_rings.h), with pieces fitted to a lobe that is narrower than the light, or else of a Gauss rule on the
// unit square, mapped as shadow rays are; for such a lobe others are spread as it reflects, and both count by the
// balance heuristic, as in shadow_rays.h. No chance is involved.
#pragma once

#include "lights/light_sampling.h"
#include "lights/profile_rings.h"
#include "lights/seen_light.h"
#include "shlight/light.h"
#include "shlight/lobe_shape.h"

namespace shlight {

/// Keeps its memory from light to light; one per thread.
class ProfileMean {
  public:
    /// The light, which is seen and has an extent, and the hit. Both are kept by reference.
    void reset(const Light& light, const ShadingFrame& frame);

    /// The bounds of what mean() returns.
    const ProfileRange& range() const { return seen_.profile().range(); }
    /// Of the hit's lobe, by more and more nodes until half as many again along each axis change it by less than
    /// the tolerance twice, or they are too many.
    double mean(const LobeShape& lobe, double cos_theta_o, double tolerance);

  private:
    struct Sums {
        double lit = 0, even = 0;
    };
    /// A lobe at a view.
    struct Reflection {
        const LobeShape* shape;
        Vec3d view;
        bool narrow;  // has nodes of its own
    };
    Sums sums(const Reflection& reflection, int points);
    /// visit(direction, weight, factor of the profile) at nodes that fill the light.
    template <class Visit>
    void for_light_nodes(int points, const Visit& visit);
    void add(const Reflection& reflection, const Vec3d& direction, double weight, double factor, Sums& sums) const;

    SeenLight seen_;
    LightSampler sampler_;
    ProfileRings rings_;
    bool has_rings_ = false;
};

}  // namespace shlight
