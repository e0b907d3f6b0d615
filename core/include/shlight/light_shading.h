// SPDX-License-Identifier: MIT
//
// Materials lit by area lights, without shadows: Eq. 5 of Zhou & Wei 2020 in each lobe's warp, fused, with the cheapest
// way to integrate each light chosen for it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "shlight/bsdf.h"
#include "shlight/types.h"

namespace shlight {

struct ShadeSettings {
    int order = 0;  ///< 1 … 64: harmonics of this order for every light; 0: whatever meets the tolerance
    double tolerance =
        kDefaultTolerance;  ///< of the radiance ÷ the material's albedo at the view, in each colour channel
};

/// Shades batch after batch of lights of one material. Keeps its memory; one per thread.
///
/// Views: cos_theta_o of each light, or one for all of them; ω_o = (sinθ_o, 0, cosθ_o). Lights that share a view are
/// cheaper as neighbours.
/// radiance: reflected towards ω_o, of lights of unit radiance. effort: empty, or per light the largest order or number
/// of values of f·cos that a lobe took; 0 where the light is hidden or mirrored.
/// T: float or double. Results depend on nothing but a light and its view.
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
    /// sizes that do not fit, cos_theta_o outside [0, 1], and as sphere_coefficients does.
    template <class T>
    void spheres(std::span<const Vec3<T>> centers, std::span<const T> radii, std::span<const double> cos_theta_o,
                 std::span<Rgb> radiance, std::span<std::int32_t> effort = {});

    /// Planar polygons of vertex_count vertices each, in either winding; throws as polygon_coefficients does, too.
    template <class T>
    void polygons(std::span<const Vec3<T>> vertices, int vertex_count, std::span<const double> cos_theta_o,
                  std::span<Rgb> radiance, std::span<std::int32_t> effort = {});

    /// Disks and ellipses as disk_coefficients takes them; throws as that does, too. A lobe reflects what it reflects
    /// of a polygon within about 1e-4 of the disk's L_00, or tolerance if that is less (docs/theory.md, 5.5);
    /// of harmonics of a given order, of 1e-4.
    template <class T>
    void disks(std::span<const Vec3<T>> centers, std::span<const Vec3<T>> half_axes_u,
               std::span<const Vec3<T>> half_axes_v, std::span<const double> cos_theta_o, std::span<Rgb> radiance,
               std::span<std::int32_t> effort = {});

  private:
    std::unique_ptr<class LightShaderWork> work_;
};

/// The same of one batch.
void shade_spheres(std::span<const Vec3d> centers, std::span<const double> radii, const Bsdf& bsdf,
                   std::span<const double> cos_theta_o, const ShadeSettings& settings, std::span<Rgb> radiance,
                   std::span<std::int32_t> effort = {});
void shade_polygons(std::span<const Vec3d> vertices, int vertex_count, const Bsdf& bsdf,
                    std::span<const double> cos_theta_o, const ShadeSettings& settings, std::span<Rgb> radiance,
                    std::span<std::int32_t> effort = {});

}  // namespace shlight
