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
#include "shadows/environment_rays.h"
#include "shlight/environment.h"
#include "tracing/hits.h"
#include "tracing/shadow_tracer.h"

namespace shlight {

/// Keeps its memory from pixel to pixel; one per thread.
class ShadowedEnvironment {
  public:
    ShadowedEnvironment(const ShadowTracer& tracer, const Environment& environment,
                        std::span<const MaterialLobes> materials);

    /// Adds the environment to the hits' radiance and noise. samples: what the hits are of; unshadowed: see
    /// EnvironmentShading; group: its, see LightTraits; point_of_hit: the shading point of each hit, none shared by
    /// pixels; pixel_seeds: one per pixel. A hit's radiance counts as part of the sum over the hits of its pixel.
    void add(const EnvironmentShading& shading, std::uint32_t group, const SampleRange& samples,
             std::span<const DirectLightParts> unshadowed, std::size_t point_count,
             std::span<const std::uint32_t> point_of_hit, std::span<const std::uint32_t> pixel_seeds, Hits& hits);
    std::uint64_t rays_traced() const { return rays_.rays_traced(); }

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
        std::uint32_t seed;
    };

    LitRange find_lit(const Hits& hits, std::size_t pixel);
    /// Adds the environment to all that find_lit has found.
    void shade_lit(Hits& hits);
    void shade_unblocked(const LitRange& pixel, Hits& hits) const;
    void shade(const LitRange& pixel, Hits& hits);
    /// The values of one lobe at a hit.
    DirectLightParts unblocked(const Hits& hits, std::size_t hit, std::size_t lobe) const;
    void shade_lobe(const LitRange& pixel, std::size_t lobe, Hits& hits);
    MaterialSums& sums_of(std::size_t material);
    /// Returns how far it may be off.
    Rgb shade_hit(std::size_t hit, std::size_t lobe, const EnvironmentRays::Sums& of_hit,
                  const MaterialSums& of_material, Hits& hits) const;
    Rgb seen_part(const Rgb& unblocked, const RaySums& of_hit, const Vec3d& kept) const;

    std::span<const MaterialLobes> materials_;
    EnvironmentRays rays_;

    SampleRange samples_{};  // of the call of add()
    const EnvironmentShading* shading_ = nullptr;
    std::uint32_t group_ = 0;
    std::span<const DirectLightParts> unshadowed_;
    std::size_t point_count_ = 0;
    std::span<const std::uint32_t> point_of_hit_;
    std::vector<std::size_t> lit_;                 // hits of some pixels
    std::vector<LitPixel> pixels_;                 // these
    std::vector<LitRange> partly_;                 // those of them in whose way something is
    std::vector<EnvironmentRays::Sums> hit_sums_;  // of one lobe, by lit hit of a pixel
    std::vector<MaterialSums> material_sums_;      // likewise
    std::vector<Rgb> deviation_;                   // by lit hit of a pixel, from its few rays
};

}  // namespace shlight
