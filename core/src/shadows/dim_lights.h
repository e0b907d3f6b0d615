// SPDX-License-Identifier: MIT
//
// Shadows of lights with extent that add too little to a pixel for rays of their own: they share some, each in
// proportion to what it adds. A scene may have thousands of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lights/light_sampling.h"
#include "lights/seen_light.h"
#include "lobes/material_lobes.h"
#include "shading/direct_light.h"
#include "shading/shading_points.h"
#include "shadows/shadow_budget.h"
#include "shadows/shadow_policy.h"
#include "shadows/shared_rays.h"
#include "shlight/light.h"
#include "shlight/sampling.h"
#include "tracing/hits.h"
#include "tracing/shadow_tracer.h"

namespace shlight {

/// Keeps its memory from light to light; one per thread.
class DimLights {
  public:
    /// Refers to the budget and the parts.
    DimLights(ShadowTracer& tracer, const ShadowBudget& budget, std::span<const MaterialLobes> materials,
              std::size_t lobe_stride, const LightParts& parts)
        : budget_(&budget), materials_(materials), lobe_stride_(lobe_stride), rays_(tracer), apart_(parts) {}

    /// To be called before the first of these lights, which the budget knows: they are referred to by number.
    void start(std::span<const Light* const> lights, const DirectLight& unshadowed, const SampleRange& samples);
    bool is_dim(std::size_t light, std::size_t pixel) const;
    /// Adds the dim ones to the hits' radiance. points: of the hits; seeds: one per group.
    void add(const ShadingPoints& points, std::span<const std::uint32_t> seeds, Hits& hits);

  private:
    /// A light of a pixel, or a point of it under a light: on a line as long as all of them are bright.
    struct Member {
        std::size_t index;
        float up_to;
    };

    /// The dim lights of a pixel; returns their brightness.
    float gather(std::size_t pixel);
    /// Asks for the gathered lights.
    void ask(std::size_t pixel, std::size_t questions, std::uint32_t seed, const Hits& hits);
    /// How bright points of a pixel are under a light.
    void gather_points(std::size_t pixel, const LightRadiance& unshadowed);
    /// density: how often it is asked for a unit of brightness.
    void ask_hit(const Light& light, const LightRadiance& unshadowed, std::size_t hit, const glm::dvec2& place,
                 double density, const Hits& hits);
    /// Adds the lights to the pixels that have asked for them.
    void finish(Hits& hits);
    /// To what points of the pixel get if nothing blocks.
    void add_unblocked(std::size_t pixel);

    const ShadowBudget* budget_;
    std::span<const MaterialLobes> materials_;
    std::size_t lobe_stride_;
    SharedRays rays_;
    std::span<const Light* const> lights_;  // of the call of start()
    const DirectLight* unshadowed_ = nullptr;
    SampleRange samples_{};
    std::vector<std::uint8_t> may_share_;    // by light
    const ShadingPoints* points_ = nullptr;  // of the call of add()
    std::vector<SharedRays::Asked> asked_;
    std::vector<Rgb> radiance_;       // by shading point, of the dim lights if nothing blocks
    KeptApart apart_;                 // of that, by pixel
    std::vector<Member> dim_;         // lights of a pixel
    std::vector<Member> dim_points_;  // of a pixel, under one of them
    SeenLight seen_;
    LightSampler sampler_;
};

}  // namespace shlight
