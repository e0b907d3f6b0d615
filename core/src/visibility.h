// SPDX-License-Identifier: MIT
//
// Shadows: the unshadowed radiance of each lobe times the ratio of shadowed to unshadowed sampling (Heitz, Hill &
// McGuire 2018, "Combining analytic direct illumination and stochastic shadows"). Of lights with extent; for others see
// ShadowedDeltas.
//
// The ratio is exact where a light is wholly seen or wholly hidden; noise lives in penumbrae only. So a quarter of the
// rays goes first, and where all those of a pixel agree, the rest is spared, but on glossy surfaces in shadow.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hits.h"
#include "material_lobes.h"
#include "shadow_rays.h"
#include "shlight/light.h"
#include "shlight/ray_tracer.h"

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
    /// To be called before the first light of other hits. brightness: of each pixel by other lights, if nothing blocks.
    void start(std::span<const float> brightness) { brightness_.assign(brightness.begin(), brightness.end()); }
    std::uint64_t rays_traced() const { return rays_.rays_traced(); }

  private:
    bool is_glossy(std::uint32_t material) const;
    void add_pixel(const Light& light, std::uint32_t seed, std::size_t begin, std::size_t end, Hits& hits);
    void find_lit(const Light& light, const Hits& hits, std::size_t begin, std::size_t end);
    /// The value of one lobe at a hit.
    float unshadowed(std::size_t hit, std::size_t lobe) const {
        return unshadowed_[lobe * (unshadowed_.size() / lobe_stride_) + point_of_hit_[hit]];
    }
    bool shines(std::size_t lit_index, std::size_t lobe) const {
        return lit_.shines[lit_index * lobe_stride_ + lobe] != 0;
    }
    /// Of how many hits one is enough to tell how much of a light a pixel sees; 1 where each must be asked.
    std::size_t stride_of(const Light& light, const Hits& hits);
    /// Asks every so many of the lit hits, and shades all of them with what these see.
    void add_minor(const Light& light, std::size_t stride, std::uint32_t seed, Hits& hits);
    void shade_unblocked(const Light& light, Hits& hits) const;
    void shade(const Light& light, Hits& hits);
    void shade_lobe(const Light& light, std::size_t lobe, Hits& hits);
    Rgb scaled_radiance(const Light& light, const Hits& hits, std::size_t hit, std::size_t lobe) const;

    /// Rays of all hits of a shading point.
    struct PointSums {
        double all = 0;
        std::uint32_t hits = 0;
    };

    std::span<const MaterialLobes> materials_;
    std::size_t lobe_stride_;
    std::uint32_t most_rays_;
    ShadowRays rays_;

    SampleRange samples_{};                        // of the call of add()
    std::uint32_t first_ray_count_ = 0;            // likewise, rays per hit of the first phase
    std::span<const float> unshadowed_;            // of the light being added
    std::span<const std::uint32_t> point_of_hit_;  // likewise
    std::vector<float> brightness_;                // of each pixel by the lights so far, if nothing blocks
    float* pixel_brightness_ = nullptr;            // of the pixel
    LitHits lit_;                                  // likewise
    LitHits all_lit_;                              // likewise, while some of them are asked
    std::vector<RaySums> hit_sums_;                // of one lobe, by lit hit
    std::vector<PointSums> point_sums_;            // likewise, by shading point
    std::vector<Rgb> deviation_;                   // of the light by lit hit, from its few rays
};

}  // namespace shlight
