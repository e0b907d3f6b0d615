// SPDX-License-Identifier: MIT
//
// Shadow rays from hits to the environment: spread as a diffuse surface reflects, as each glossy lobe does, and, where
// the environment is a picture, as its luminance. Those of many pixels are drawn before they are traced, so that
// Embree's packets are full, and only those of pixels where something was met are weighed.
//
// All sets serve all lobes, weighted by the balance heuristic (Veach & Guibas 1995): a ray of direction ω that any of
// the sets could have drawn counts f·cos L / Σ p_set, with p_set the density of a set; all have equally many rays. A
// mirror has one ray of its own.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lobes/material_lobes.h"
#include "shadows/pixel_points.h"
#include "shadows/ray_sums.h"
#include "shadows/shadow_policy.h"
#include "shadows/shadow_ray_spawner.h"
#include "shadows/weighed_rays.h"
#include "shlight/environment.h"
#include "tracing/hits.h"
#include "tracing/shadow_tracer.h"

namespace shlight {

/// Keeps its memory from pixel to pixel; one per thread.
class EnvironmentRays {
  public:
    /// Sums for the environment without its bright spots, and for the spots.
    struct Sums {
        RaySums smooth, spots;
    };

    EnvironmentRays(ShadowTracer& tracer, const Environment& environment, std::span<const MaterialLobes> materials);

    /// Forgets all rays. hits and lit, some of them, stay as they are until the next call.
    void start(const Hits& hits, std::span<const std::size_t> lit);
    /// Draws the rays of a pixel's lit hits. samples.shadow_rays: of each set; seed: see PixelPoints.
    void draw(const LitRange& pixel, const SampleRange& samples, std::uint32_t seed);
    /// Traces all rays that were drawn.
    void trace();

    /// Whether anything takes light away from any ray of a pixel.
    bool any_occluded(const LitRange& pixel) const;
    /// To be called for each pixel whose sums are asked for, and then, for all of them together, …
    void weigh(const LitRange& pixel);
    /// … this.
    void find_weights();
    /// split: or else all is in Sums::smooth.
    Sums sum(std::size_t lit_index, std::size_t lobe, bool split);

  private:
    /// The sets of rays that a material takes.
    struct Sets {
        std::vector<std::size_t> lobes;  // whose directions they have
        bool mirror = false;
    };
    /// The rays of a hit: that of a mirror is the last.
    struct Run {
        std::size_t begin = 0, mirror = 0, end = 0;
    };
    /// Radiance ÷ density: without spots, of spots.
    struct Weight {
        Rgb smooth, spots;
    };
    /// A ray that is weighed.
    struct Lookup {
        std::size_t ray;
        Vec3f direction;     // in the frame of the picture
        float lobe_density;  // of all sets but the picture's; 1 for a mirror
        bool mirror;
    };

    /// Finds the shapes of a hit's sets, in shapes_.
    void find_shapes(std::size_t hit);
    void draw_hit(std::size_t lit_index, std::uint32_t rays);
    void draw_set(const ShadowRaySpawner& start, std::size_t hit, std::size_t set, std::uint32_t rays);
    /// Draws rays in proportion to the picture's luminance.
    void draw_map(const ShadowRaySpawner& start, std::size_t hit, std::uint32_t rays);
    /// A hit's rays but for the mirror's, in weighed_.
    void gather(std::size_t lit_index);
    /// Adds a ray, unless the direction is below the horizon.
    void push(const ShadowRaySpawner& start, const Vec3d& direction);
    void weigh_hit(std::size_t lit_index);
    void weigh_map(const struct EnvironmentMap& map);

    ShadowTracer* tracer_;
    const Environment* environment_;
    std::span<const MaterialLobes> lobes_;
    std::vector<Sets> materials_;
    std::size_t set_stride_ = 1;  // sets of rays of any hit

    const Hits* hits_ = nullptr;  // of the call of start()
    std::span<const std::size_t> lit_;
    std::vector<Run> runs_;  // by lit hit
    PixelPoints points_;
    std::vector<LobeShape> shapes_;  // of a hit's sets
    std::vector<Vec3f> directions_;  // along the axes of the world
    std::vector<Ray> rays_;
    std::vector<Rgb> visible_;     // once traced
    std::vector<Weight> weights_;  // of those weighed
    std::vector<Lookup> lookups_;
    WeighedRays weighed_;
};

}  // namespace shlight
