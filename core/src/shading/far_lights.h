// SPDX-License-Identifier: MIT
//
// Lights of a picture that can be summed up from afar, and the lobes that can reflect the sum.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "lobes/material_lobes.h"
#include "lobes/sh_projection.h"
#include "shlight/light.h"
#include "shlight/types.h"

namespace shlight {

/// Bands of a sum of lights: 0 … kFarLightOrder - 1.
inline constexpr int kFarLightOrder = 16;

/// A light as if it had no extent.
struct FarLight {
    Vec3d position;
    Vec3d normal;  ///< 0: it shines alike in all directions
    bool two_sided;
    bool casts_shadows;
    std::uint32_t group;  ///< see LightTraits
    double extent;        ///< no point of it is farther from its position
    Rgb intensity;        ///< [W sr⁻¹] along the normal
    std::size_t index;

    /// On a surface that faces it, of intensity 1. way: to its position, of any length > 0.
    double irradiance(const Vec3d& way) const;
};

/// A lobe that reflects sums of lights.
class FarLobe {
  public:
    FarLobe() = default;
    explicit FarLobe(const LobeShape& shape);

    std::shared_ptr<const ShProjection> lobe;  ///< null: too narrow
    /// Root of Σ f_lm² over the bands that sums omit, at the views of view_grid.h.
    std::vector<float> tails;
    /// Likewise: the root mean square, over all turns, of the second difference of f·cos / d² at the middle of a cube
    /// about the point, ÷ (its diagonal ÷ d)².
    std::vector<float> curvatures;

    float tail(double cos_theta_o) const { return largest_near(tails, cos_theta_o); }
    float curvature(double cos_theta_o) const { return largest_near(curvatures, cos_theta_o); }

  private:
    static float largest_near(const std::vector<float>& by_view, double cos_theta_o);
};

/// Immutable; any number of threads may read it.
class FarLights {
  public:
    /// Holds nothing where there are too few lights for sums to pay, and where order, of RenderSettings, is given:
    /// every light then takes it.
    FarLights() = default;
    FarLights(std::span<const Light> lights, std::span<const MaterialLobes> materials, int order);

    std::span<const FarLight> lights() const { return lights_; }
    const FarLobe& lobe(std::size_t material, std::size_t lobe) const { return lobes_[material][lobe]; }
    /// Whether no light takes light away.
    bool all_positive() const { return all_positive_; }

  private:
    std::vector<FarLight> lights_;
    std::vector<std::vector<FarLobe>> lobes_;  // of each material
    bool all_positive_ = true;
};

}  // namespace shlight
