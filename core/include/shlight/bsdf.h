// SPDX-License-Identifier: MIT
//
// Materials: sums of coloured lobes. Immutable values, cheap to copy.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "shlight/boosted_fit.h"
#include "shlight/lobe_shape.h"
#include "shlight/types.h"

namespace shlight {

/// A weight that depends only on the view angle, tabulated at the view angles of the fits.
class ViewWeight {
  public:
    /// Throws std::invalid_argument unless there are kViewNodes nodes, all in 0 … 1.
    explicit ViewWeight(std::vector<float> nodes);
    float operator()(float cos_theta_o) const;
    const std::vector<float>& nodes() const { return nodes_; }

  private:
    std::vector<float> nodes_;
};

/// One lobe of a material: f·cos = color · weight(θ_o) · shape.
struct Lobe {
    LobeShape shape;
    std::shared_ptr<const BoostedFit> fit;  ///< null for a mirror, and for an anisotropic shape
    Rgb color;
    std::shared_ptr<const ViewWeight> weight;  ///< null: 1
    /// Not 0: the width varies from hit to hit, equally for all lobes of a material with the same number. The shape's
    /// width is then unused, and there is no fit.
    std::uint32_t varying_width = 0;
    int only_order = 0;  ///< of the fit; 0: several

    /// Whether the form of its shape is another at each hit.
    bool varies() const { return varying_width != 0 || is_anisotropic(shape); }
    Rgb scale(float cos_theta_o) const { return weight ? color * (*weight)(cos_theta_o) : color; }
    /// ∫ shape dω; of an anisotropic shape at its own azimuth.
    double albedo(double cos_theta_o) const;
};

/// Largest component of a colour; products of a colour and a lobe then stay within a float's range.
inline constexpr float kLargestColor = 1e10F;

/// Roughness below which a lobe is a mirror. Such a lobe would be narrower than 1e-5 rad, less than any pixel or light.
/// Varying roughness is at least this.
inline constexpr float kLeastRoughness = 0.003F;

class Bsdf {
  public:
    Bsdf() = default;  ///< black

    /// One lobe. Throws std::invalid_argument for a colour outside [0, kLargestColor].
    /// order: the only one in which harmonics shade it, 1 … 64; 0: the cheapest of several.
    static Bsdf lobe(const LobeShape& shape, const Rgb& color, std::shared_ptr<const ViewWeight> weight = nullptr,
                     int order = 0);
    /// Throws std::invalid_argument for an albedo outside [0, kLargestColor].
    static Bsdf lambert(const Rgb& albedo);
    /// GGX with height-correlated Smith masking and F = f0 + (1 - f0) s; s = (1 - cosθ_d)⁵, or with ior > 1 the exact
    /// dielectric curve remapped to 0 … 1. Above an ior of 3.73 that curve falls below its value at normal incidence; s
    /// is 0 there, as in Cycles. alpha = roughness²; below kLeastRoughness the lobe is a perfect mirror.
    /// Throws for roughness outside [0, 1], f0 outside [0, kLargestColor], or an ior that is not finite and above 1.
    static Bsdf ggx(float roughness, const Rgb& f0, double ior = 0);
    /// The lobes of ggx() with colour 1, of widths that LightShader is given for each light; the second one, the rise
    /// from f0, is missing above the ior at which the curve is flat. Throws for the ior as ggx() does.
    static Bsdf varying_ggx(double ior = 0);
    /// One of them.
    static Bsdf varying(const GgxShape& shape);
    /// The channels of a table, RGB or grey, as lobes. order: as of lobe().
    static Bsdf table(const std::shared_ptr<const LobeTable>& table, int order = 0);
    /// top + base · (1 - max over RGB of top's directional albedo).
    static Bsdf layer(const Bsdf& top, const Bsdf& base);

    Bsdf operator+(const Bsdf& other) const;
    /// Multiplies all colours. Throws if the factor or a product is outside [0, kLargestColor].
    Bsdf scaled(const Rgb& factor) const;

    /// The lobes that are not black, with colour 1.
    Bsdf uncolored() const;

    const std::vector<Lobe>& lobes() const { return lobes_; }
    /// Whether the azimuth of the view from the surface's tangent on matters.
    bool is_anisotropic() const;
    /// f·cos in the shading frame, whose x is the tangent; 0 for mirrors.
    Rgb evaluate(const Vec3d& wi, const Vec3d& wo) const;
    /// ∫ f·cos dω.
    Rgb albedo(double cos_theta_o) const;

  private:
    std::vector<Lobe> lobes_;
};

}  // namespace shlight
