// SPDX-License-Identifier: MIT
//
// Shadows of lights that are summed up (FarLightSum): some are drawn, in proportion to how bright they are, and a pixel
// gets the share of the sum that its hits see of these.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lobes/material_lobes.h"
#include "shading/far_light_sum.h"
#include "shading/shading_points.h"
#include "shadows/shadow_budget.h"
#include "shadows/shadow_policy.h"
#include "shadows/shared_rays.h"
#include "tracing/hits.h"
#include "tracing/shadow_tracer.h"

namespace shlight {

/// Keeps its memory; one per thread.
class ShadowedFarLights {
  public:
    /// lights: of the picture.
    ShadowedFarLights(ShadowTracer& tracer, std::span<const MaterialLobes> materials, std::span<const Light> lights);

    /// Adds the sum to the hits' radiance. index: of it in the budget; samples: what the hits are of; pixel_seeds: one
    /// per pixel. What few rays are off by is the same at all hits of a pixel.
    void add(const FarLightSum& far_light_sum, const ShadingPoints& points, const SampleRange& samples,
             const ShadowBudget& budget, std::size_t index, std::span<const std::uint32_t> pixel_seeds, Hits& hits);

  private:
    void ask(const FarLightSum& far_light_sum, std::size_t questions, std::uint32_t seed, std::size_t pixel,
             const Hits& hits);
    /// What a hit, the one numbered first + hit, reflects of a light, as one number.
    float value(const FarLight& light, const Hits& hits, std::size_t first, std::size_t hit) const;
    Ray ray(const FarLight& light, const Hits& hits, std::size_t hit) const;

    /// Parts of the sum's light that points of the pixel get if nothing blocks.
    void find_apart(const FarLightSum& far_light_sum, const ShadingPoints& points, std::size_t pixel,
                    const LightParts& parts);

    SharedRays rays_;
    std::vector<Rgb> apart_;        // parts of a pixel's light if nothing blocks
    std::vector<Rgb> point_apart_;  // likewise of a point's
    std::span<const MaterialLobes> materials_;
    std::span<const Light> lights_;
};

}  // namespace shlight
