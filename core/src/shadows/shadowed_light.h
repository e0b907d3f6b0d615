// SPDX-License-Identifier: MIT
//
// Shadows: the unshadowed radiance of each lobe times the ratio of shadowed to unshadowed sampling (Heitz, Hill &
// McGuire 2018, "Combining analytic direct illumination and stochastic shadows"). Of lights with extent; for others see
// ShadowedDeltas.
//
// The ratio is exact where a light is wholly seen or wholly hidden; noise lives in penumbrae only.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lobes/material_lobes.h"
#include "shading/shading_points.h"
#include "shading/unshadowed_radiance.h"
#include "shadows/shadow_budget.h"
#include "shadows/shadow_rays.h"
#include "shadows/shared_shadow_lights.h"
#include "shlight/light.h"
#include "tracing/hits.h"
#include "tracing/shadow_tracer.h"

namespace shlight {

/// Keeps its memory from light to light; one per thread.
class ShadowedLight {
  public:
    ShadowedLight(ShadowTracer& tracer, const ShadowBudget& budget, std::span<const MaterialLobes> materials,
                  std::size_t lobe_stride, const LightParts& parts);
    ~ShadowedLight() = default;
    // The parts refer to each other.
    ShadowedLight(const ShadowedLight&) = delete;
    ShadowedLight& operator=(const ShadowedLight&) = delete;

    /// Adds lights, the first that the budget knows, to the hits' radiance and noise. unshadowed, points: of these;
    /// samples: what the hits are of; seeds: one per group. A hit's radiance counts as part of the sum over the hits of
    /// its group.
    void add(std::span<const Light* const> lights, const UnshadowedRadiance& unshadowed, const ShadingPoints& points,
             const SampleRange& samples, std::span<const std::uint32_t> seeds, Hits& hits);

  private:
    /// A pixel's lit hits.
    struct LitPixel {
        LitRange range;
        std::size_t pixel;
        SampleRange samples;
        std::uint32_t seed;
    };

    void add_light(const Light& light, std::size_t index, std::span<const std::uint32_t> seeds, Hits& hits);

    LitRange find_lit(const Light& light, const Hits& hits, std::size_t pixel);
    /// Adds the light to all that find_lit has found.
    void shade_lit(const Light& light, Hits& hits);
    /// The value of one lobe at a hit.
    float unshadowed(std::size_t hit, std::size_t lobe) const {
        return unshadowed_.values[lobe * points_->size() + points_->of_hit[hit]];
    }
    bool shines(std::size_t lit_index, std::size_t lobe) const {
        return lit_.shines[lit_index * lobe_stride_ + lobe] != 0;
    }
    void shade_unblocked(const LitRange& pixel, Hits& hits) const;
    void shade(const LitRange& pixel, Hits& hits);
    void shade_lobe(const LitRange& pixel, std::size_t lobe, Hits& hits);
    Rgb scaled_radiance(const Hits& hits, std::size_t hit, std::size_t lobe) const;

    /// Sums over a pixel's hits with one material, or over one hit of a mirror: unblocked radiance, and the sums of its
    /// rays.
    struct MaterialSums {
        std::uint32_t material;
        std::size_t hit;
        Vec3d unblocked{0}, rays{0}, seen{0};
    };
    MaterialSums& sums_of(const Hits& hits, std::size_t hit, std::size_t lobe);

    std::span<const MaterialLobes> materials_;
    std::size_t lobe_stride_;
    const ShadowBudget* budget_;
    ShadowRays rays_;

    SampleRange samples_{};       // of the call of add()
    bool shadows_ = false;        // whether the light being added casts any
    std::uint32_t group_ = 0;     // of that light
    LightRadiance unshadowed_{};  // of that light
    const ShadingPoints* points_ = nullptr;
    SharedShadowLights shared_;
    LitHits lit_;                              // of some pixels
    std::vector<LitPixel> pixels_;             // these
    std::vector<RaySums> hit_sums_;            // of one lobe, by lit hit of a pixel
    std::vector<MaterialSums> material_sums_;  // likewise
    std::vector<Rgb> deviation_;               // of the light by lit hit of a pixel, from its few rays
};

}  // namespace shlight
