// SPDX-License-Identifier: MIT
//
// The mean of a light's emission profile, weighted by a lobe's f·cos.
//
// The radiance of a light with a profile is the exact radiance of the even light times Σ w L f / Σ w f over nodes on
// the light, L being the profile's factor and f the lobe's f·cos. Errors of the rule for a narrow lobe are in both sums
// and cancel. The nodes are those of rings (profile_rings.h), with pieces fitted to a lobe narrower than the light, or
// else a Gauss rule on the unit square, mapped like shadow rays. In the latter case a narrow lobe adds nodes
// distributed as it reflects, and the balance heuristic combines both, as in shadow_rays.h. The result is
// deterministic.
#pragma once

#include "lights/light_sampling.h"
#include "lights/local_light.h"
#include "lights/profile_rings.h"
#include "shlight/light.h"
#include "shlight/lobe_shape.h"

namespace shlight {

/// Memory is reused from light to light; one per thread.
class ProfileMean {
  public:
    /// Precondition: the light has extent and is seen. The light and the frame are kept by reference.
    void reset(const Light& light, const ShadingFrame& frame);

    /// The bounds of what mean() returns.
    const ProfileRange& range() const { return seen_.profile().range(); }
    /// The mean for one lobe. The number of nodes along each axis grows by half until successive means agree within the
    /// tolerance twice, or the largest rule is reached. Precondition: no mirror.
    double mean(const LobeShape& lobe, double cos_theta_o, double tolerance);

  private:
    struct Sums {
        double lit = 0, even = 0;
    };
    /// A lobe at one view.
    struct Reflection {
        const LobeShape* shape;
        Vec3d view;
        bool narrow;  // whether it adds nodes
    };
    Sums sums(const Reflection& reflection, int points);
    /// visit(direction, weight, factor of the profile) at nodes that fill the light.
    template <class Visit>
    void for_light_nodes(int points, const Visit& visit);
    void add(const Reflection& reflection, const Vec3d& direction, double weight, double factor, Sums& sums) const;

    LocalLight seen_;
    LightSampler sampler_;
    ProfileRings rings_;
    bool has_rings_ = false;
};

}  // namespace shlight
