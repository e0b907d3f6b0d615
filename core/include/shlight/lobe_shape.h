// SPDX-License-Identifier: MIT
//
// Scalar lobe shapes f·cos: a BRDF times the cosine at the light's side, isotropic, without colour.
//
// A shape answers for itself through the members below, and through the functions that visit whichever it is; nobody
// else asks which. f·cos and the density over directions are also known in lanes, see lobes/lobe_lanes-inl.h.
// All is in the shading frame; wi, wo: unit vectors towards light and view.
#pragma once

#include <compare>
#include <cstddef>
#include <variant>

#include <glm/vec2.hpp>

#include "shlight/types.h"

namespace shlight {

/// f·cos = cosθ_i / π.
struct LambertShape {
    static constexpr bool kGlossy = false;
    double width() const { return 1; }
    double value(const Vec3d& wi, const Vec3d& wo) const;
    double albedo(double cos_theta_o) const;
    Vec3d sample(const Vec3d& wo, const glm::dvec2& point) const;
    double density(const Vec3d& wo, const Vec3d& wi) const;
    double largest_density(const Vec3d& wo) const;
    LambertShape sampled() const { return *this; }

    auto operator<=>(const LambertShape&) const = default;
};

/// Diffuse lobes that are not Lambert's, without parameters.
enum class Diffuse {
    /// cosθ_i (1 + t), with t = (ω_i·ω_o - cosθ_i cosθ_o), over max(cosθ_i, cosθ_o) where it is positive: what
    /// roughness adds in the improved Oren–Nayar model of Fujii (mimosa-pudica.net/improved-oren-nayar.html).
    oren_nayar,
    /// cosθ_i (π/2 - 2/3 - G(cosθ_i)): what that model's first bounce loses, which further bounces give back.
    oren_nayar_loss,
    /// Lambert's lobe of a bump, with ω_o the smooth normal: times the share of it that the smooth surface does not
    /// hide (Estevez, Lecocq & Stein 2019, "A Microfacet-Based Shadowing Function to Solve the Bump Terminator
    /// Problem").
    bumped
};

struct DiffuseShape {
    Diffuse kind;

    static constexpr bool kGlossy = false;
    double width() const { return 1; }
    double value(const Vec3d& wi, const Vec3d& wo) const;
    double albedo(double cos_theta_o) const;
    Vec3d sample(const Vec3d& wo, const glm::dvec2& point) const;
    double density(const Vec3d& wo, const Vec3d& wi) const;
    double largest_density(const Vec3d& wo) const;
    LambertShape sampled() const { return {}; }

    // NOLINTNEXTLINE(modernize-use-nullptr): the linter misreads <=>
    auto operator<=>(const DiffuseShape&) const = default;
};

/// What multiplies D G / (4 cosθ_i cosθ_o).
enum class Fresnel {
    one,         ///< 1: the part that f0 scales, and metals without Fresnel
    schlick,     ///< (1 - cosθ_d)⁵: the part that 1 - f0 scales
    dielectric,  ///< max(0, F(ior, cosθ_d) - F(ior, 1)) / (1 - F(ior, 1)): the same from the exact Fresnel equations
    dip          ///< cosθ_d (1 - cosθ_d)⁶: what metals' edge tint takes away (Kutz, Hašan & Edmondson 2021)
};

/// GGX with height-correlated Smith masking (Heitz 2014), f·cos = F D G₂ / (4 cosθ_o).
/// A colour f0 needs two shapes: f0 · {one} + (1 - f0) · ({schlick or dielectric}) · …, see Bsdf::ggx.
struct GgxShape {
    double alpha;                    ///< roughness² in Blender's terms, 0 … 1; 0 is a perfect mirror
    Fresnel fresnel = Fresnel::one;  ///< which factor is folded in
    double ior = 1.5;                ///< used by Fresnel::dielectric only

    static constexpr bool kGlossy = true;
    double width() const { return alpha; }
    double value(const Vec3d& wi, const Vec3d& wo) const;
    double albedo(double cos_theta_o) const;
    /// Directions are spread as the microfacets that the viewer sees reflect: the normals' density is
    /// G₁ ⟨ω_o·h⟩ D / cosθ_o (Heitz 2018, "Sampling the GGX distribution of visible normals"; by spherical caps,
    /// Dupuy & Benyoub 2023). f·cos over the density is then F G₂/G₁, never large for any roughness and view.
    Vec3d sample(const Vec3d& wo, const glm::dvec2& point) const;
    double density(const Vec3d& wo, const Vec3d& wi) const;
    double largest_density(const Vec3d& wo) const;
    GgxShape sampled() const { return {alpha}; }

    // NOLINTNEXTLINE(modernize-use-nullptr): the linter misreads <=>
    auto operator<=>(const GgxShape&) const = default;
};

using LobeShape = std::variant<LambertShape, DiffuseShape, GgxShape>;

/// Half width of the peak about the mirror direction [rad]; 1 where there is none.
double lobe_width(const LobeShape& shape);
/// The same shape of another width; of a shape that has only one, itself.
LobeShape with_width(const LobeShape& shape, double width);
/// Whether there is a peak: the lobe is shaded in a warp, and lights may spare it ("visible to glossy rays").
bool is_glossy(const LobeShape& shape);
/// All of its light comes from one direction, and f·cos is 0 everywhere else: the width is 0.
bool is_mirror(const LobeShape& shape);
/// Where that is, for a view in the xz-plane.
inline Vec3d mirrored(const Vec3d& wo) {
    return {-wo.x, 0, wo.z};
}

/// f·cos; 0 where either direction lies below the horizon.
double lobe_value(const LobeShape& shape, const Vec3d& wi, const Vec3d& wo);
/// The same of many directions (x[i], y[i], z[i]); 0 for a mirror.
void lobe_values(const LobeShape& shape, const double* x, const double* y, const double* z, std::size_t count,
                 const Vec3d& wo, float* values);
/// ∫ f·cos dω. By cubature for what is not known in closed form.
double lobe_albedo(const LobeShape& shape, double cos_theta_o);

/// A direction that the lobe reflects to ω_o, above the horizon and in the xz-plane: unit, may lie below the horizon,
/// continuous in the point (0 … 1)² but for one line. Of a mirror the only one.
Vec3d sample_lobe(const LobeShape& shape, const Vec3d& wo, const glm::dvec2& point);
/// Per solid angle, 0 below the horizon; no density is greater than the largest. Precondition: no mirror.
double lobe_density(const LobeShape& shape, const Vec3d& wo, const Vec3d& wi);
double largest_lobe_density(const LobeShape& shape, const Vec3d& wo);
/// The simplest shape of the same density: lobes for which it is the same can share their directions.
LobeShape sampled_shape(const LobeShape& shape);

}  // namespace shlight
