// SPDX-License-Identifier: MIT
//
// Shadow rays from hits to one light: spread as the light draws points of itself, and as each lobe reflects. Those of
// many pixels are drawn before they are traced, so that Embree's packets are full and alike, and only those of pixels
// where something was met are weighed.
//
// All sets serve all lobes, weighted by the balance heuristic (Veach & Guibas 1995): a ray of direction ω that any of
// the sets could have drawn counts f·cos L / Σ p_set, with p_set the density of a set; all sets have equally many rays.
// A lobe much wider than the light lives on the light's set, one much narrower on its own, with no switch between them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lighting/pixel_points.h"
#include "lighting/ray_sums.h"
#include "lighting/shadow_policy.h"
#include "lighting/shadow_targets.h"
#include "lighting/terminator_rays.h"
#include "lighting/weighed_rays.h"
#include "lobes/material_lobes.h"
#include "tracing/hits.h"
#include "tracing/light_bits.h"
#include "tracing/shadow_tracer.h"

namespace shlight {

/// Hits that a light reaches if nothing is between.
struct LitHits {
    void clear() {
        hit.clear();
        shines.clear();
    }

    std::vector<std::size_t> hit;
    std::vector<std::uint8_t> shines;  ///< hit.size() × lobe_stride: whether the lobe reflects any of it
};

/// Keeps its memory from light to light; one per thread.
class ShadowRays {
  public:
    /// Sums for the light without its bright spots, and for the spots.
    struct Sums {
        RaySums smooth, spots;
        std::size_t rays = 0;
        /// Whether most rays go where the light is open and few are the lobe's own, so that the sums tell little of
        /// what nothing would block.
        bool guided = false;
    };

    ShadowRays(ShadowTracer& tracer, std::span<const MaterialLobes> materials, std::size_t lobe_stride);

    /// Forgets all rays. hits and lit, which the target has been given, stay as they are until the next call.
    void start(ShadowTarget& target, const Hits& hits, const LitHits& lit);
    /// Draws the rays of a pixel's hits among lit. samples.shadow_rays: of each set; seed: see PixelPoints.
    void draw(const LitRange& pixel, const SampleRange& samples, std::uint32_t seed);
    /// Traces all rays that were drawn, or lets them all reach the light.
    void trace(bool shadows);

    /// Whether rays of a pixel see the light, which has this number, and whether any does not.
    LightBits visibility(const LitRange& pixel, std::size_t light) const;
    /// Whether rays of a pixel's hits go where the light is open, as a guide knows.
    bool is_guided(const LitRange& pixel) const;
    /// Weighs the rays of the pixels whose sums are asked for.
    void weigh(std::span<const LitRange> pixels);
    /// lit_index: of LitHits; split: or else all is in Sums::smooth.
    Sums sum(std::size_t lit_index, std::size_t lobe, bool split);

  private:
    /// The lobes of a material as whose rays sets are spread: lobes that are spread alike share one.
    struct Material {
        std::vector<std::size_t> lobes;        // of each set one
        std::vector<std::size_t> set_of_lobe;  // index of lobes
    };
    /// The rays of a hit.
    struct Run {
        std::size_t begin = 0, end = 0;
        bool guided = false;
    };

    void draw_hit(std::size_t lit_index, std::uint32_t rays);
    void draw_set(std::size_t lit_index, std::size_t set, const LobeShape& shape, std::uint32_t rays);
    bool shines(std::size_t lit_index, const Material& material, std::size_t set) const;
    /// The shape from which a set's directions are drawn at a hit.
    LobeShape set_shape(std::size_t hit, std::size_t set) const;
    /// A hit's rays, in weighed_.
    void gather(std::size_t lit_index);
    void add_densities(std::size_t lit_index);
    /// Rays of a set ÷ those that the light draws.
    float& set_share(std::size_t lit_index, std::size_t set) { return set_share_[lit_index * set_stride_ + set]; }

    ShadowTracer* tracer_;
    std::size_t lobe_stride_;
    std::span<const MaterialLobes> lobes_;
    std::vector<Material> materials_;
    std::size_t set_stride_ = 1;  // sets of rays of any hit, but for the light's

    ShadowTarget* target_ = nullptr;  // of the call of start()
    const Hits* hits_ = nullptr;
    const LitHits* lit_ = nullptr;
    PixelPoints points_;
    DrawnRays rays_;
    TerminatorRays terminator_;
    std::vector<Run> runs_;            // by lit hit
    std::vector<float> set_share_;     // lit hits × set_stride
    std::vector<float> lobe_density_;  // of rays, summed up over the sets of lobes
    std::vector<std::size_t> wanted_;  // rays to weigh
    WeighedRays weighed_;
};

}  // namespace shlight
