// SPDX-License-Identifier: MIT
//
// Materials lit by area lights, without shadows: Eq. 5 of Zhou & Wei 2020 in each lobe's boosted frame, or a cheaper
// integral where one meets the tolerance, chosen for each light.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "shlight/bsdf.h"
#include "shlight/types.h"

namespace shlight {

struct ShadeSettings {
    int order = 0;  ///< 1 … 64: harmonics of this order for every light; 0: the cheapest method within the tolerance
    double tolerance = kDefaultTolerance;  ///< error of radiance ÷ albedo at the view, in each colour channel
};

/// A material may differ from light to light. Spans are empty, or have for each light an element of each lobe that is
/// not black.
struct LightLobes {
    std::span<const Rgb> colors;    ///< factors of the lobes' own, at least 0
    std::span<const float> alphas;  ///< α = roughness², 0 < α ≤ 1, of the lobes of Bsdf::varying_ggx

    bool empty() const { return colors.empty() && alphas.empty(); }
};

/// Shades batches of lights with one material. Memory is reused; one per thread.
///
/// Views: cos_theta_o of each light, or one for all; ω_o = (sinθ_o, 0, cosθ_o). Lights with the same view are cheaper
/// if they are adjacent. azimuth: of the view from the surface's tangent on [rad], of each light, or one for all; none:
/// 0. Only anisotropic materials read it.
/// own: empty unless lobes differ from light to light.
/// radiance: reflected towards ω_o, from lights of unit radiance. effort: empty, or for each light the largest order or
/// number of values of f·cos that a lobe took; 0 where the light is hidden or mirrored.
/// T: float or double. A result depends only on the light and its view.
class LightShader {
  public:
    /// Throws std::invalid_argument naming the argument: an order outside 0 … 64, a tolerance ≤ 0 or not finite.
    LightShader(const Bsdf& bsdf, const ShadeSettings& settings);
    ~LightShader();
    LightShader(LightShader&&) noexcept;
    LightShader& operator=(LightShader&&) noexcept;
    LightShader(const LightShader&) = delete;
    LightShader& operator=(const LightShader&) = delete;

    /// Sphere lights, from centre and radius in the shading frame. Throws std::invalid_argument naming the argument:
    /// sizes that do not fit, cos_theta_o outside [0, 1], an azimuth that is not finite, and as sphere_coefficients
    /// does.
    template <class T>
    void spheres(std::span<const Vec3<T>> centers, std::span<const T> radii, std::span<const double> cos_theta_o,
                 std::span<Rgb> radiance, std::span<std::int32_t> effort = {}, std::span<const double> azimuth = {},
                 const LightLobes& own = {});

    /// Planar polygons of vertex_count vertices each, in either winding; throws as polygon_coefficients does, too.
    template <class T>
    void polygons(std::span<const Vec3<T>> vertices, int vertex_count, std::span<const double> cos_theta_o,
                  std::span<Rgb> radiance, std::span<std::int32_t> effort = {}, std::span<const double> azimuth = {},
                  const LightLobes& own = {});

    /// Disks and ellipses as in disk_coefficients, which also defines the exceptions. A polygon replaces the disk, to
    /// within about 1e-4 of its L_00, or the tolerance if that is smaller (docs/theory.md, 5.5); harmonics of a given
    /// order are within 1e-4.
    template <class T>
    void disks(std::span<const Vec3<T>> centers, std::span<const Vec3<T>> half_axes_u,
               std::span<const Vec3<T>> half_axes_v, std::span<const double> cos_theta_o, std::span<Rgb> radiance,
               std::span<std::int32_t> effort = {}, std::span<const double> azimuth = {}, const LightLobes& own = {});

  private:
    std::unique_ptr<class LightShaderWork> work_;
};

}  // namespace shlight
