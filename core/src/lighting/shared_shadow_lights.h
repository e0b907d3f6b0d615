// SPDX-License-Identifier: MIT
//
// Shadows of lights with extent that add too little to a group of hits for rays of their own. They share shadow
// samples: each is one ray from one hit to one light, both drawn in proportion to what they add, and the visible share
// of the samples is taken to be that of all these lights. A scene may have thousands of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lighting/shading_points.h"
#include "lighting/shadow_budget.h"
#include "lighting/shadow_policy.h"
#include "lighting/shadow_targets.h"
#include "lighting/terminator_rays.h"
#include "lighting/unshadowed_light.h"
#include "lobes/material_lobes.h"
#include "shlight/light.h"
#include "shlight/sampling.h"
#include "tracing/hits.h"
#include "tracing/light_parts.h"
#include "tracing/shadow_tracer.h"

namespace shlight {

/// Keeps its memory from light to light; one per thread.
class SharedShadowLights {
  public:
    /// Refers to the budget and the parts.
    SharedShadowLights(ShadowTracer& tracer, const ShadowBudget& budget, std::span<const MaterialLobes> materials,
                       std::size_t lobe_stride, const LightParts& parts)
        : tracer_(&tracer),
          budget_(&budget),
          materials_(materials),
          lobe_stride_(lobe_stride),
          apart_(parts),
          terminator_(materials) {}

    /// To be called before the first of these lights, which the budget knows: they are referred to by number. begin,
    /// end: of those that are added.
    void start(std::span<const Light> lights, std::span<const UnshadowedLight> unshadowed, const SampleRange& samples,
               std::size_t begin, std::size_t end);
    bool is_dim(std::size_t light, std::size_t pixel) const;
    /// Adds the dim ones to the hits' radiance. points: of the hits; seeds: one per group.
    void add(const ShadingPoints& points, std::span<const std::uint32_t> seeds, Hits& hits);

  private:
    /// A light of a pixel, or a point of it under a light: on a line as long as all of them are bright.
    struct Member {
        std::size_t index;
        float up_to;
    };

    /// A ray from a hit to a light.
    struct ShadowSample {
        std::size_t hit, light;
        double density;  // samples that a unit of brightness gets
        float let_in;    // of what reaches the hit
    };
    /// The samples of a pixel: those numbered begin … end - 1.
    struct PixelSamples {
        std::size_t pixel, begin, end;
    };
    /// The visible share of a pixel's shared light in each colour channel, and the variance of that estimate.
    struct Share {
        Rgb seen{0}, variance{0};
        LightBits lights;
    };

    /// The dim lights of a pixel.
    struct DimLights {
        std::vector<Member> members;
        double rays = 0;  // that a hit has for all of them
    };
    /// Finds the dim lights of some pixels.
    void gather(std::size_t first, std::span<DimLights> pixels) const;
    /// Draws shadow samples for the lights of dim_.
    void request(std::size_t pixel, std::size_t count, std::uint32_t seed, const Hits& hits);
    /// How bright points of a pixel are under a light.
    void gather_points(std::size_t pixel, const UnshadowedLight& unshadowed);
    /// density: how many samples a unit of brightness gets.
    void request_from(std::size_t hit, std::size_t light, const glm::dvec2& place, double density, const Hits& hits);
    /// Adds the lights to the pixels that have samples.
    void finish(Hits& hits);
    Share share(const PixelSamples& own, const Hits& hits);
    /// Returns the light that a sample stands for if nothing blocks it, ≥ 0.
    Rgb value(std::size_t sample, const Hits& hits) const;
    /// Adds what hits of a pixel see of the lights to their parts: of each group according to its samples, scaled so
    /// that all groups add up to share.seen.
    void keep_apart(const PixelSamples& own, const Share& share, Hits& hits);
    /// To what points of the pixel get if nothing blocks.
    void add_unblocked(std::size_t pixel);
    void add_parts(std::size_t point);

    ShadowTracer* tracer_;
    const ShadowBudget* budget_;
    std::span<const MaterialLobes> materials_;
    std::size_t lobe_stride_;
    std::span<const Light> lights_;                // of the call of start()
    std::span<const UnshadowedLight> unshadowed_;  // likewise
    SampleRange samples_{};
    std::size_t begin_ = 0, end_ = 0;        // likewise
    std::vector<std::uint8_t> may_share_;    // of these
    const ShadingPoints* points_ = nullptr;  // of the call of add()
    std::vector<PixelSamples> pixels_;
    std::vector<ShadowSample> shadow_samples_;
    DrawnRays rays_;                               // of each sample
    std::vector<Rgb> values_;                      // likewise, where its pixel has rays that something blocks; or 0
    std::vector<Rgb> group_seen_, group_sampled_;  // of light groups
    std::vector<Rgb> radiance_;                    // by shading point, of the dim lights if nothing blocks
    LightGroupBuffer apart_;                       // of that, likewise
    static constexpr std::size_t kPixelsAtOnce = 16;
    std::array<DimLights, kPixelsAtOnce> gathered_;
    std::span<const Member> dim_;               // of one of these
    std::vector<Member> dim_points_;            // of a pixel, under one of them
    std::array<float, kRaysAtOnce> u_{}, v_{};  // a sample's point of the unit square, the first
    LightTarget target_;
    TerminatorRays terminator_;
};

}  // namespace shlight
