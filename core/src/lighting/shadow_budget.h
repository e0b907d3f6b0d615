// SPDX-License-Identifier: MIT
//
// How bright each light makes groups of hits if nothing blocks it, and how many shadow rays it gets for that.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lighting/shading_points.h"
#include "lighting/shadow_policy.h"
#include "lighting/unshadowed_light.h"
#include "tracing/light_bits.h"

namespace shlight {

/// A light's brightness over a group is that of its reflected radiance, summed up over the hits. Keeps its memory; one
/// per thread.
class ShadowBudget {
  public:
    explicit ShadowBudget(std::size_t lobe_stride) : lobe_stride_(lobe_stride) {}

    /// Forgets all lights but these. points: stay as they are until the next call.
    /// penumbrae: for each group the lights, as in LightBits, that rays near it have found partly hidden.
    void start(const ShadingPoints& points, std::span<const UnshadowedLight> lights,
               std::span<const std::uint32_t> penumbrae);

    float of_group(std::size_t light, std::size_t group) const { return own_[light * all_.size() + group]; }
    /// Brightness under a light of start(), over all hits of a point.
    float of_point(const UnshadowedLight& light, std::size_t point) const;
    /// Brightness of each group from all lights. Callers add sources without extent, which are too many to be stored.
    std::span<float> all() { return all_; }
    /// Shadow rays of each hit for a light. If n lights share rays in proportion to their brightness, the variance is
    /// at most that of one light with all the rays. Where all rays near a group agree about the light, they are as if
    /// one ray of a hit were the most.
    float rays(std::size_t light, std::size_t group, const SampleRange& samples) const {
        return kRaysByShare * static_cast<float>(most_rays(light, group, samples)) * of_group(light, group) /
               all_[group];
    }
    /// The same for a light with a whole number of rays, at least one.
    SampleRange samples_of(std::size_t light, std::size_t group, const SampleRange& samples) const;

  private:
    void find_weights();
    /// Brightness of all points under a light.
    void find_points(const UnshadowedLight& light);
    std::uint32_t most_rays(std::size_t light, std::size_t group, const SampleRange& samples) const {
        const bool is_partly_hidden = (penumbrae_[group] & LightBits::bit(light)) != 0;
        return is_partly_hidden ? samples.shadow_rays : std::min(samples.shadow_rays, 1U);
    }

    std::size_t lobe_stride_;
    const ShadingPoints* points_ = nullptr;
    std::span<const std::uint32_t> penumbrae_;
    std::vector<float> all_;        // by group
    std::vector<float> own_;        // lights × groups
    std::vector<float> of_points_;  // of one light
    std::vector<float> weights_;    // magnitudes of ShadingPoints::weight, lobes × channels × points
};

}  // namespace shlight
