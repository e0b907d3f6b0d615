// SPDX-License-Identifier: MIT
//
// Sources without extent: all of a scene's, as arrays that lanes can read.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "lights/delta_kernel.h"
#include "shlight/light.h"
#include "shlight/lobe_shape.h"
#include "shlight/ray_tracer.h"
#include "tracing/hits.h"

namespace shlight {

std::vector<const Light*> pointers_to(std::span<const Light> lights);

/// Some sources: those numbered begin … begin + count - 1. Both are multiples of kDeltaLanes.
struct DeltaRange {
    std::size_t begin, count;
};

/// What some sources look like from a point; see DeltaViewArrays.
class DeltaViews {
  public:
    void resize(std::size_t count);
    DeltaViewArrays arrays() { return {x.data(), y.data(), z.data(), irradiance.data()}; }

    std::vector<double> x, y, z, irradiance;
};

/// Refers to the lights.
class DeltaLights {
  public:
    /// Precondition: is_delta of each.
    explicit DeltaLights(std::span<const Light* const> lights);

    /// With what fills the last vector up, which shines nowhere.
    std::size_t padded_size() const { return x_.size(); }
    bool casts_shadows(std::size_t i) const { return casts_shadows_[i] != 0; }
    /// See LightTraits.
    std::uint32_t group(std::size_t i) const { return group_[i]; }
    Rgb strength(std::size_t i) const { return {r_[i], g_[i], b_[i]}; }
    ColorArrays strengths(std::size_t begin) const { return {&r_[begin], &g_[begin], &b_[begin]}; }
    /// The absolute values of these.
    ColorArrays magnitudes(std::size_t begin) const { return {&abs_r_[begin], &abs_g_[begin], &abs_b_[begin]}; }

    /// error: of the point. A source within twice that of it is not seen.
    void see(const DeltaRange& range, const ShadingFrame& frame, double error, DeltaViews& views) const;
    /// The same of one source.
    bool shines(std::size_t i, const ShadingFrame& frame, double error) const;
    /// values[i]: f·cos of a lobe towards each source of a range times its irradiance, 0 where the source or a mirror
    /// does without.
    void reflect(const DeltaRange& range, const DeltaViews& views, const LobeShape& shape, float cos_theta_o,
                 float* values) const;
    /// A shadow ray. origin: see Hits::shadow_origin.
    Ray ray(std::size_t i, const Vec3d& origin) const;
    /// The least changing_distance().
    double changing_distance(const Vec3d& position) const;

  private:
    DeltaArrays arrays(const DeltaRange& range) const;
    Vec3d way(std::size_t i, const Vec3d& from) const {
        return {x_[i] - w_[i] * from.x, y_[i] - w_[i] * from.y, z_[i] - w_[i] * from.z};
    }
    /// Of the profile, for the world direction to a source, of any length > 0.
    double factor(std::size_t i, const Vec3d& way) const;

    std::vector<const Light*> lights_;
    std::vector<double> x_, y_, z_, w_;
    std::vector<float> r_, g_, b_, abs_r_, abs_g_, abs_b_;
    std::vector<float> lights_diffuse_, lights_glossy_;  // 1 or 0
    std::vector<std::uint8_t> casts_shadows_, is_even_;  // likewise
    std::vector<std::uint32_t> group_;
    std::vector<std::size_t> uneven_;  // sources that have a profile
};

}  // namespace shlight
