// SPDX-License-Identifier: MIT
//
// Shadows under the environment: the unshadowed radiance of each lobe, known without noise, corrected by what rays see
// of it, in each colour channel, and for a picture's bright spots apart from the rest. docs/renderer.md, 7, says how.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "environment/environment_shading.h"
#include "lobes/material_lobes.h"
#include "shading/shading_points.h"
#include "shadows/environment_rays.h"
#include "shadows/shadow_budget.h"
#include "shlight/environment.h"
#include "tracing/hits.h"
#include "tracing/shadow_tracer.h"

namespace shlight {

/// Keeps its memory from pixel to pixel; one per thread.
class ShadowedEnvironment {
  public:
    ShadowedEnvironment(ShadowTracer& tracer, const Environment& environment, std::span<const MaterialLobes> materials);

    /// Adds the environment to the hits' radiance and noise. shading, group: see EnvironmentShading and LightTraits;
    /// unshadowed: its light at points, of which groups share none; index: of it in the budget; samples: what the hits
    /// are of; seeds: one per group. A hit's radiance counts as part of the sum over the hits of its group.
    void add(const EnvironmentShading& shading, std::uint32_t group, std::span<const UnshadowedParts> unshadowed,
             const ShadingPoints& points, const ShadowBudget& budget, std::size_t index, const SampleRange& samples,
             std::span<const std::uint32_t> seeds, Hits& hits);

  private:
    /// Rays of all hits of a pixel that have a material.
    struct MaterialSums {
        std::size_t material;
        EnvironmentRays::Sums sums;
        Vec3d kept_smooth, kept_spots;  // see kept_share
    };

    /// A pixel's lit hits.
    struct LitPixel {
        LitRange range;
        std::size_t pixel;
        SampleRange samples;
        std::uint32_t seed;
    };

    LitRange find_lit(const Hits& hits, std::size_t pixel);
    /// Adds the environment to all that find_lit has found.
    void shade_lit(bool shadows, Hits& hits);
    void shade_unblocked(const LitRange& pixel, Hits& hits) const;
    void shade(const LitPixel& pixel, Hits& hits);
    /// The values of one lobe at a hit.
    UnshadowedParts unblocked(const Hits& hits, std::size_t hit, std::size_t lobe) const;
    void shade_lobe(const LitPixel& pixel, std::size_t lobe, Hits& hits);
    MaterialSums& sums_of(std::size_t material);
    /// Returns how far it may be off. rays: of each set.
    Rgb shade_hit(std::size_t hit, std::size_t lobe, const EnvironmentRays::Sums& of_hit,
                  const MaterialSums& of_material, double rays, Hits& hits) const;

    std::span<const MaterialLobes> materials_;
    EnvironmentRays rays_;

    const EnvironmentShading* shading_ = nullptr;  // of the call of add()
    std::uint32_t group_ = 0;
    std::span<const UnshadowedParts> unshadowed_;
    const ShadingPoints* points_ = nullptr;
    std::vector<std::size_t> lit_;                 // hits of some pixels
    std::vector<LitPixel> pixels_;                 // these
    std::vector<LitPixel> partly_;                 // those of them in whose way something is
    std::vector<EnvironmentRays::Sums> hit_sums_;  // of one lobe, by lit hit of a pixel
    std::vector<MaterialSums> material_sums_;      // likewise
    std::vector<Rgb> deviation_;                   // by lit hit of a pixel, from its few rays
};

}  // namespace shlight
