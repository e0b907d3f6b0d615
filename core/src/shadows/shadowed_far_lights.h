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
#include "tracing/hits.h"
#include "tracing/shadow_tracer.h"

namespace shlight {

/// Keeps its memory; one per thread.
class ShadowedFarLights {
  public:
    /// lights: of the picture.
    ShadowedFarLights(const ShadowTracer& tracer, std::span<const MaterialLobes> materials,
                      std::span<const Light> lights);

    /// Adds the sum to the hits' radiance. shadows: whether any are cast; pixel_seeds: one per pixel;
    /// brightness: of each pixel by these and all other lights, if nothing blocks. No noise is added: what few rays are
    /// off by is the same at all hits of a pixel.
    void add(const FarLightSum& far_light_sum, const ShadingPoints& points, bool shadows,
             std::span<const std::uint32_t> pixel_seeds, std::span<const float> brightness, Hits& hits);
    std::uint64_t rays_traced() const { return rays_traced_; }

  private:
    /// The share that is seen from a pixel's hits.
    Rgb find_share(const FarLightSum& far_light_sum, std::size_t questions, std::uint32_t seed, std::size_t pixel,
                   const Hits& hits);
    /// What a hit, the one numbered first + hit, reflects of a light, as one number.
    float value(const FarLight& light, const Hits& hits, std::size_t first, std::size_t hit) const;
    Ray ray(const FarLight& light, const Hits& hits, std::size_t hit) const;

    const ShadowTracer* tracer_;
    std::span<const MaterialLobes> materials_;
    std::span<const Light> lights_;
    std::uint64_t rays_traced_ = 0;
    std::vector<Ray> rays_;
    std::vector<float> values_;  // of the rays
    std::vector<Rgb> visible_;
};

}  // namespace shlight
