// SPDX-License-Identifier: MIT
//
// All sources without extent of a scene, in arrays that lanes can read.
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

/// The sources begin … begin + count - 1; both numbers are multiples of kDeltaLanes.
struct DeltaRange {
    std::size_t begin, count;
};

/// Storage for the DeltaViewArrays of some sources.
class DeltaViews {
  public:
    void resize(std::size_t count);
    DeltaViewArrays arrays() { return {x.data(), y.data(), z.data(), irradiance.data()}; }

    std::vector<double> x, y, z, irradiance;
};

/// The lights must outlive this.
class DeltaLights {
  public:
    /// Precondition: is_delta() of all lights.
    explicit DeltaLights(std::span<const Light> lights);

    /// Number of sources with padding, which has no strength.
    std::size_t padded_size() const { return x_.size(); }
    bool casts_shadows(std::size_t i) const { return casts_shadows_[i] != 0; }
    /// See LightTraits.
    std::uint32_t group(std::size_t i) const { return group_[i]; }
    Rgb strength(std::size_t i) const { return {r_[i], g_[i], b_[i]}; }
    /// Absolute values of the strengths.
    ColorArrays magnitudes(std::size_t begin) const {
        return {abs_r_.data() + begin, abs_g_.data() + begin, abs_b_.data() + begin};
    }

    /// Views of a range of sources. error: that of the point's position [m]; sources within twice the error are dark.
    void see(const DeltaRange& range, const ShadingFrame& frame, double error, DeltaViews& views) const;
    /// Whether see() finds irradiance from source i.
    bool shines(std::size_t i, const ShadingFrame& frame, double error) const;
    /// values[i]: f·cos of a lobe towards source i of a range, times its irradiance; 0 for a mirror, and for sources
    /// that do not light such lobes.
    void reflect(const DeltaRange& range, const DeltaViews& views, const LobeShape& shape, float cos_theta_o,
                 float* values) const;
    /// Whether some do not light all light sets.
    bool are_linked() const { return are_linked_; }
    bool lights(std::size_t i, std::uint32_t light_set) const { return links_[i].lights(light_set); }
    /// To source i, of any length.
    Vec3d way(std::size_t i, const Vec3d& from) const {
        return {x_[i] - w_[i] * from.x, y_[i] - w_[i] * from.y, z_[i] - w_[i] * from.z};
    }
    /// A shadow ray to source i. origin: see Hits::shadow_start.
    Ray ray(std::size_t i, const Vec3d& origin) const;
    /// The least changing_distance() of all sources.
    double changing_distance(const Vec3d& position) const;

  private:
    DeltaArrays arrays(const DeltaRange& range) const;
    /// The emission profile's factor of source i. way: world vector to the source, of any length > 0.
    double factor(std::size_t i, const Vec3d& way) const;

    std::span<const Light> lights_;
    std::vector<double> x_, y_, z_, w_;
    std::vector<float> r_, g_, b_, abs_r_, abs_g_, abs_b_;
    std::vector<float> lights_diffuse_, lights_glossy_;  // 1: it lights such lobes; 0: it does not
    std::vector<std::uint8_t> casts_shadows_, is_even_;  // 1 or 0
    std::vector<std::uint32_t> group_;
    std::vector<LightLinks> links_;
    bool are_linked_ = false;
    std::vector<std::size_t> uneven_;  // numbers of the sources that have a profile
};

}  // namespace shlight
