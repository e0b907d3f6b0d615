// SPDX-License-Identifier: MIT
//
// What hits reflect of sources without extent, with their shadows. A scene may have thousands of them: they are seen in
// lanes, and one that adds little to a pixel is sampled by few rays.
//
// A source is wholly seen from a hit or not at all. So one ray from each hit leaves no noise, and a pixel from which
// all rays reach the source, or none, needs no more than a factor for it. The few rays of a dim source start from
// hits drawn in proportion to what these reflect of it: the share of rays that reach it is then right on average.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lighting/shading_points.h"
#include "lights/delta_lights.h"
#include "lobes/material_lobes.h"
#include "shlight/render_report.h"
#include "tracing/hits.h"
#include "tracing/shadow_tracer.h"

namespace shlight {

/// Keeps its memory from call to call; one per thread.
class ShadowedDeltas {
  public:
    ShadowedDeltas(ShadowTracer& tracer, std::span<const MaterialLobes> materials, std::size_t lobe_stride);

    /// Adds all sources to the hits' radiance, and what the hits take to the report. shadows: whether any are cast;
    /// pixel_seeds: one per pixel. brightness: of each pixel by other lights, to which that by the sources is added, if
    /// nothing blocks. No noise is added: what the few rays of dim sources are off by is the same at all hits of a
    /// pixel.
    void add(const DeltaLights& lights, const ShadingPoints& points, bool shadows,
             std::span<const std::uint32_t> pixel_seeds, Hits& hits, std::span<float> brightness, RenderReport& report);

  private:
    /// The points first_point … last_point - 1 of a pixel.
    struct PixelRange {
        std::size_t hit_count;
        std::size_t first_point, last_point;
        std::uint32_t seed;

        std::size_t point_count() const { return last_point - first_point; }
    };
    /// A hit from which a source is sampled.
    struct ShadowSample {
        std::size_t hit;
        std::uint32_t ray;  // its number; kAbove or kBelow: none is needed
    };
    /// A source, and the samples before which its own end.
    struct SampledSource {
        std::size_t light;
        std::size_t end;
        bool each_hit;
    };

    /// others: brightness by other lights; returns that by all.
    float add_pixel(const ShadingPoints& points, const PixelRange& pixel, float others, Hits& hits,
                    RenderReport& report);
    /// Values of a range of sources at each point of the pixel, and the sources' brightness.
    void find_values(const ShadingPoints& points, const PixelRange& pixel, const DeltaRange& range);
    void request(const ShadingPoints& points, const PixelRange& pixel, const DeltaRange& range, float all,
                 const Hits& hits);
    /// Every hit that the source lights, or some in proportion to how much.
    void request_all(const ShadingPoints& points, const PixelRange& pixel, const DeltaRange& range, std::size_t light,
                     const Hits& hits);
    void request_some(const ShadingPoints& points, const PixelRange& pixel, const DeltaRange& range, std::size_t light,
                      std::size_t rays, const Hits& hits);
    void add_sample(const DeltaRange& range, std::size_t light, std::size_t hit, const Hits& hits);
    void trace();
    /// Finds the visible share of each source that all hits of the pixel receive equally; adds the others.
    void find_shares(const ShadingPoints& points, const PixelRange& pixel, const DeltaRange& range, Hits& hits);
    void add_shares(const ShadingPoints& points, const PixelRange& pixel, const DeltaRange& range, Hits& hits);
    /// Adds to Hits::apart the light of the sources that a lobe of hits of one point reflects.
    void keep_apart(const float* values, const DeltaRange& range, std::span<const std::size_t> own_hits,
                    std::size_t lobe, Hits& hits) const;
    /// The same of some of them with this sum of weights.
    void add_parts(const float* values, const DeltaRange& range, const Rgb& weight, LightKind kind,
                   std::span<Rgb> apart) const;
    std::uint64_t count_values(const ShadingPoints& points, const PixelRange& pixel, const DeltaRange& range) const;

    float* values(std::size_t point_in_pixel, std::size_t lobe, const DeltaRange& range) {
        return values_.data() + (point_in_pixel * lobe_stride_ + lobe) * range.count;
    }
    const float* values(std::size_t point_in_pixel, std::size_t lobe, const DeltaRange& range) const {
        return values_.data() + (point_in_pixel * lobe_stride_ + lobe) * range.count;
    }

    ShadowTracer* tracer_;
    std::span<const MaterialLobes> materials_;
    std::size_t lobe_stride_;
    const DeltaLights* lights_ = nullptr;  // of the call of add()
    bool shadows_ = false;

    // Buffers for one pixel and a range of sources:
    DeltaViews views_;
    std::vector<float> values_;            // points × lobe_stride × sources
    std::vector<float> point_brightness_;  // points × sources, of the hits of a point together
    std::vector<float> brightness_;        // by source
    std::vector<SampledSource> sampled_;
    std::vector<ShadowSample> samples_;
    std::vector<Ray> rays_;
    std::vector<Rgb> visible_;
    std::vector<float> seen_r_, seen_g_, seen_b_;  // by source: its strength times the share that is seen
};

}  // namespace shlight
