// SPDX-License-Identifier: MIT
//
// Shadow rays from the hits of a pixel to the environment: spread as a diffuse surface reflects, as each glossy lobe
// does, and, where the environment is a picture, as its luminance.
//
// All sets serve all lobes, weighted by the balance heuristic (Veach & Guibas 1995): a ray of direction ω that any of
// the sets could have drawn counts f·cos L / Σ p_set, with p_set the density of a set; all have equally many rays. A
// mirror has one ray of its own.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lobes/material_lobes.h"
#include "shadows/ray_sums.h"
#include "shadows/shadow_policy.h"
#include "shlight/environment.h"
#include "tracing/hits.h"
#include "tracing/shadow_tracer.h"

namespace shlight {

/// Keeps its memory from pixel to pixel; one per thread.
class EnvironmentRays {
  public:
    /// Of the environment without a picture's bright spots, and of these.
    struct Sums {
        RaySums smooth, spots;
    };

    EnvironmentRays(const ShadowTracer& tracer, const Environment& environment,
                    std::span<const MaterialLobes> materials);

    /// lit: the hits; phase.rays_per_hit: of each set; seed: of the pixel, whose phases differ in nothing else.
    void trace(const Hits& hits, std::span<const std::size_t> lit, const RayPhase& phase, std::uint32_t seed);

    /// Whether nothing was met since the last first phase.
    bool all_free() const;
    /// Of all phases; lit_index: of the hit; split: or else all is in Sums::smooth.
    Sums sum(const Hits& hits, std::span<const std::size_t> lit, std::size_t lit_index, std::size_t lobe,
             bool split) const;
    std::uint64_t rays_traced() const { return rays_traced_; }

  private:
    /// The sets of rays that a material takes.
    struct Sets {
        std::vector<std::size_t> lobes;  // whose directions they have
        bool mirror = false;
    };
    /// The rays of a hit in one phase.
    struct Run {
        std::size_t begin, end;
        std::optional<std::size_t> mirror;
    };
    class Directions;

    Run draw(const Hits& hits, std::size_t hit, const RayPhase& phase, std::uint32_t seed);

    const ShadowTracer* tracer_;
    const Environment* environment_;
    std::span<const MaterialLobes> lobes_;
    std::vector<Sets> materials_;
    std::uint64_t rays_traced_ = 0;

    std::vector<LobeShape> shapes_;  // of a hit's sets
    std::vector<Ray> rays_;          // of the phase
    std::vector<Vec3f> directions_;
    std::vector<Rgb> weights_, spot_weights_;  // radiance ÷ density: without spots, of spots
    std::vector<Rgb> visible_;
    std::vector<Run> runs_;  // phases × lit hits
};

}  // namespace shlight
