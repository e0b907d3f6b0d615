// SPDX-License-Identifier: MIT
//
// Shadows: the unshadowed radiance of each lobe times the ratio of shadowed to unshadowed sampling (Heitz, Hill &
// McGuire 2018, "Combining analytic direct illumination and stochastic shadows").
//
// The ratio is exact where a light is wholly seen or wholly hidden; noise lives in penumbrae only. So a quarter of the
// rays goes first, and where all those of a pixel agree, the rest is spared.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hits.h"
#include "light_sampling.h"
#include "material_lobes.h"
#include "shlight/light.h"
#include "shlight/ray_tracer.h"
#include "shlight/render.h"

namespace shlight {

/// Keeps its memory from light to light; one per thread.
class ShadowedLight {
  public:
    /// most_rays: per camera ray and light, of any call of add().
    ShadowedLight(const RayTracer& tracer, std::uint32_t most_rays, std::span<const MaterialLobes> materials,
                  std::size_t lobe_stride);

    /// Adds one light to the hits' radiance and noise. samples: what the hits are of; unshadowed: see
    /// Unshadowed::light; point_of_hit: the shading point of each hit, none shared by pixels; pixel_seeds: one per
    /// pixel, other for each light. A hit's radiance counts as part of the sum over the hits of its shading point.
    void add(const Light& light, const SampleRange& samples, std::span<const float> unshadowed,
             std::span<const std::uint32_t> point_of_hit, std::span<const std::uint32_t> pixel_seeds, Hits& hits);
    std::uint64_t rays_traced() const { return rays_traced_; }

  private:
    /// Part of the rays of each hit: which of the pixel's points they take, and where their results lie.
    struct Phase {
        std::uint32_t first_point, rays_per_hit;
        std::size_t offset;
    };

    void add_pixel(const Light& light, std::uint32_t seed, std::size_t begin, std::size_t end, Hits& hits);
    /// The value of one lobe at a hit.
    float unshadowed(std::size_t hit, std::size_t lobe) const {
        return unshadowed_[lobe * (unshadowed_.size() / lobe_stride_) + point_of_hit_[hit]];
    }
    bool is_lit(const Light& light, const Hits& hits, std::size_t hit) const;
    void trace(const Light& light, const Hits& hits, const Phase& phase, std::uint32_t seed);
    /// Sums over the rays of a hit: of weight, and of weight times a lobe; and the shares of them that were not
    /// blocked.
    struct RaySums {
        double all = 0, seen = 0, lobe_all = 0, lobe_seen = 0;
        std::uint32_t hits = 0;
    };
    RaySums sum(const LobeShape& shape, const Vec3d& towards_viewer, std::size_t lit_index,
                std::span<const Phase> phases) const;
    void shade_unblocked(const Light& light, Hits& hits) const;
    void shade(const Light& light, std::span<const Phase> phases, Hits& hits);
    void shade_lobe(const Light& light, std::size_t lobe, std::span<const Phase> phases, Hits& hits);
    Rgb scaled_radiance(const Light& light, const Hits& hits, std::size_t hit, std::size_t lobe) const;

    const RayTracer* tracer_;
    std::span<const MaterialLobes> materials_;
    std::size_t lobe_stride_;
    std::uint32_t most_rays_;
    std::uint64_t rays_traced_ = 0;

    SampleRange samples_{};                        // of the call of add()
    std::uint32_t first_ray_count_ = 0;            // likewise, rays per hit of the first phase
    std::span<const float> unshadowed_;            // of the light being added
    std::span<const std::uint32_t> point_of_hit_;  // likewise
    std::vector<std::size_t> lit_;                 // hits of the pixel that the light reaches if nothing is between
    std::vector<Ray> rays_;
    std::vector<Vec3f> directions_;  // in the hits' frames
    std::vector<float> weights_;
    std::vector<std::uint8_t> blocked_;
    std::vector<RaySums> hit_sums_, point_sums_;  // of one lobe, by lit hit and by shading point
    std::vector<Rgb> deviation_;                  // of the light by lit hit, from its few rays
    PolygonSampler polygon_sampler_;
};

}  // namespace shlight
