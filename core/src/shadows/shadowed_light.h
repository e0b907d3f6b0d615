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

#include "lobes/material_lobes.h"
#include "shading/direct_light.h"
#include "shading/light_brightness.h"
#include "shading/shading_points.h"
#include "shadows/dim_lights.h"
#include "shadows/shadow_rays.h"
#include "shlight/light.h"
#include "tracing/hits.h"
#include "tracing/shadow_tracer.h"

namespace shlight {

/// Keeps its memory from light to light; one per thread.
class ShadowedLight {
  public:
    /// most_rays: per camera ray and light, of any call of add().
    ShadowedLight(const ShadowTracer& tracer, std::uint32_t most_rays, std::span<const MaterialLobes> materials,
                  std::size_t lobe_stride);
    ~ShadowedLight() = default;
    // The parts refer to each other.
    ShadowedLight(const ShadowedLight&) = delete;
    ShadowedLight& operator=(const ShadowedLight&) = delete;

    /// To be called before the first light of other hits. points: theirs, which stay as they are until finish();
    /// brightness: of each pixel by other lights, if nothing blocks.
    void start(const ShadingPoints& points, std::span<const float> brightness);
    /// Lights that are to be added: those are bright or dim beside all that are known so far.
    void expect(std::span<const Light* const> lights, const DirectLight& unshadowed) {
        brightness_.expect(lights, unshadowed);
    }
    /// Of the pixels, by all lights that were expected and those that were not, see start().
    std::span<const float> brightness() const { return brightness_.all(); }
    /// Adds one light to the hits' radiance and noise. index: its place among those expected last; samples: what the
    /// hits are of; unshadowed: see DirectLight::light; pixel_seeds: one per pixel, other for each light. A hit's
    /// radiance counts as part of the sum over the hits of its shading point.
    void add(const Light& light, std::size_t index, const SampleRange& samples, const LightRadiance& unshadowed,
             std::span<const std::uint32_t> pixel_seeds, Hits& hits);
    /// To be called after the last light.
    void finish(Hits& hits) const { dim_.finish(hits); }
    std::uint64_t rays_traced() const { return rays_.rays_traced(); }

  private:
    bool is_glossy(std::uint32_t material) const;
    void add_pixel(const Light& light, std::uint32_t seed, std::size_t begin, std::size_t end, Hits& hits);
    void find_lit(const Light& light, const Hits& hits, std::size_t begin, std::size_t end);
    /// The value of one lobe at a hit.
    float unshadowed(std::size_t hit, std::size_t lobe) const {
        return unshadowed_.values[lobe * points_->size() + points_->of_hit[hit]];
    }
    bool shines(std::size_t lit_index, std::size_t lobe) const {
        return lit_.shines[lit_index * lobe_stride_ + lobe] != 0;
    }
    void shade_unblocked(Hits& hits) const;
    void shade(Hits& hits);
    void shade_lobe(std::size_t lobe, Hits& hits);
    Rgb scaled_radiance(const Hits& hits, std::size_t hit, std::size_t lobe) const;

    /// Rays of all hits of a shading point.
    struct PointSums {
        Vec3d all{0};
        std::uint32_t hits = 0;
    };

    std::span<const MaterialLobes> materials_;
    std::size_t lobe_stride_;
    std::uint32_t most_rays_;
    ShadowRays rays_;

    SampleRange samples_{};       // of the call of add()
    bool shadows_ = false;        // likewise, whether the light casts any
    LightRadiance unshadowed_{};  // of the light being added
    const ShadingPoints* points_ = nullptr;
    LightBrightness brightness_;
    DimLights dim_;
    LitHits lit_;                        // of the pixel
    std::vector<RaySums> hit_sums_;      // of one lobe, by lit hit
    std::vector<PointSums> point_sums_;  // likewise, by shading point
    std::vector<Rgb> deviation_;         // of the light by lit hit, from its few rays
};

}  // namespace shlight
