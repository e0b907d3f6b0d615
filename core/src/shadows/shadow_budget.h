// SPDX-License-Identifier: MIT
//
// How bright each light makes groups of hits if nothing blocks it, and how many shadow rays it gets for that.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "shading/shading_points.h"
#include "shading/unshadowed_radiance.h"
#include "shadows/shadow_policy.h"
#include "shlight/light.h"

namespace shlight {

/// Sum of the absolute values of a colour's channels.
inline float brightness_of(const Rgb& color) {
    return glm::dot(glm::abs(color), Rgb(1));
}

/// A light's brightness over a group is that of its reflected radiance, summed up over the hits. Keeps its memory; one
/// per thread.
class ShadowBudget {
  public:
    explicit ShadowBudget(std::size_t lobe_stride) : lobe_stride_(lobe_stride) {}

    /// Forgets all lights but these. points: stay as they are until the next call.
    void start(const ShadingPoints& points, std::size_t light_count, const UnshadowedRadiance& unshadowed);
    /// Counts another light in; returns its index. own(point): its brightness over one hit of a point.
    template <class Own>
    std::size_t add(const Own& own) {
        for (std::size_t group = 0; group < all_.size(); ++group) {
            float sum = 0;
            for (std::size_t point = points_->pixel_begin[group]; point < points_->pixel_begin[group + 1]; ++point) {
                sum += static_cast<float>(points_->hit_count(point)) * own(point);
            }
            own_.push_back(sum);
            all_[group] += sum;
        }
        return own_.size() / all_.size() - 1;
    }

    float of_group(std::size_t light, std::size_t group) const { return own_[light * all_.size() + group]; }
    /// Brightness under a light of start(), over all hits of a point.
    float of_point(const LightRadiance& unshadowed, std::size_t point) const;
    /// Brightness of each group from all lights. Callers add sources without extent, which are too many to be stored.
    std::span<float> all() { return all_; }
    /// Shadow rays of each hit for a light with this brightness over the group, or for several lights that share them.
    /// If n lights share rays in proportion to their brightness, the variance is at most that of one light with all the
    /// rays.
    float rays(float own, std::size_t group, const SampleRange& samples) const {
        return kRaysByShare * static_cast<float>(samples.shadow_rays) * own / all_[group];
    }
    /// The same for a light with a whole number of rays, at least one.
    SampleRange samples_of(std::size_t light, std::size_t group, const SampleRange& samples) const;

  private:
    std::size_t lobe_stride_;
    const ShadingPoints* points_ = nullptr;
    std::vector<float> all_;  // by group
    std::vector<float> own_;  // lights × groups
};

}  // namespace shlight
