// SPDX-License-Identifier: MIT
//
// Shadows of lights with extent and of the environment: the unshadowed radiance of each lobe, known without noise,
// corrected by what rays see of it, in each colour channel, and for a picture's bright spots apart from the rest. Exact
// where a light is wholly seen or wholly hidden. docs/renderer.md, 7, says how. For sources without extent see
// ShadowedDeltas.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lighting/shading_points.h"
#include "lighting/shadow_budget.h"
#include "lighting/shadow_rays.h"
#include "lighting/unshadowed_light.h"
#include "lobes/material_lobes.h"
#include "tracing/hits.h"
#include "tracing/shadow_tracer.h"

namespace shlight {

/// Keeps its memory from light to light; one per thread.
class ShadowedLight {
  public:
    ShadowedLight(ShadowTracer& tracer, const ShadowBudget& budget, std::span<const MaterialLobes> materials,
                  std::size_t lobe_stride)
        : lobe_stride_(lobe_stride), budget_(&budget), rays_(tracer, materials, lobe_stride) {}

    /// To be called before the lights of these points. samples: what the hits are of; seeds: one per group.
    void start(const ShadingPoints& points, const SampleRange& samples, std::span<const std::uint32_t> seeds) {
        points_ = &points;
        samples_ = samples;
        seeds_ = seeds;
    }
    /// Adds a light to the hits' radiance and noise, but for groups that leave it out. index: of it in the budget;
    /// leaves_out(group). A hit's radiance counts as part of the sum over the hits of its group.
    template <class LeavesOut>
    void add(ShadowTarget& target, const UnshadowedLight& light, std::size_t index, const LeavesOut& leaves_out,
             Hits& hits) {
        target_ = &target;
        light_ = light;
        index_ = index;
        for (std::size_t group = 0; group < hits.pixel_count(); ++group) {
            if (budget_->of_group(index, group) > 0 && !leaves_out(group)) {
                find_lit(group, hits);
            }
            if (lit_.hit.size() >= kHitsAtOnce) {
                shade_lit(hits);
            }
        }
        shade_lit(hits);
    }

  private:
    /// A group's lit hits.
    struct LitGroup {
        LitRange range;
        std::size_t group;
        SampleRange samples;
        std::uint32_t seed;
    };
    /// Rays of all hits of a group that have a material.
    struct MaterialSums {
        std::uint32_t material;
        ShadowRays::Sums sums;
        Vec3d kept_smooth, kept_spots;  // see kept_share
    };

    void find_lit(std::size_t group, const Hits& hits);
    /// Adds the light to all that find_lit has found.
    void shade_lit(Hits& hits);
    void shade_unblocked(const LitRange& range, Hits& hits) const;
    void shade(const LitGroup& group, Hits& hits);
    void shade_lobe(const LitGroup& group, std::size_t lobe, Hits& hits);
    /// guided: see ShadowRays::Sums.
    MaterialSums& sums_of(std::uint32_t material, bool guided);
    /// Returns how far it may be off. rays: of each set.
    Rgb shade_hit(std::size_t hit, std::size_t lobe, const ShadowRays::Sums& of_hit, const MaterialSums& of_material,
                  double rays, Hits& hits) const;
    /// The light's value of one lobe at a hit.
    template <class Radiance>
    Rgb unblocked(const Radiance& part, const Hits& hits, std::size_t hit, std::size_t lobe) const {
        return hits.weight(hit, lobe) * part[lobe * points_->size() + points_->of_hit[hit]];
    }
    bool shines(std::size_t lit_index, std::size_t lobe) const {
        return lit_.shines[lit_index * lobe_stride_ + lobe] != 0;
    }

    std::size_t lobe_stride_;
    const ShadowBudget* budget_;
    ShadowRays rays_;

    const ShadingPoints* points_ = nullptr;  // of the call of start()
    SampleRange samples_{};
    std::span<const std::uint32_t> seeds_;
    ShadowTarget* target_ = nullptr;  // of the call of add()
    UnshadowedLight light_{};
    std::size_t index_ = 0;                    // of it in the budget
    LitHits lit_;                              // of some groups
    std::vector<LitGroup> groups_;             // these
    std::vector<LitGroup> occluded_;           // those of them in whose way something is
    std::vector<LitRange> ranges_;             // likewise
    std::vector<ShadowRays::Sums> hit_sums_;   // of one lobe, by lit hit of a group
    std::vector<MaterialSums> material_sums_;  // likewise
    std::vector<Rgb> deviation_;               // by lit hit of a group, from its few rays
};

}  // namespace shlight
