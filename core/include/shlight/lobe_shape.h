// SPDX-License-Identifier: MIT
//
// Shapes of lobes: scalar, isotropic f·cos, a BRDF times the cosine at the light, without colour.
//
// A shape is a struct with members as DiffuseShape has, and those that rays are drawn from with members as LambertShape
// has; the functions at the end visit the variant, and no other code depends on the type of shape.
// lobes/lobe_lanes-inl.h has f·cos and density in lanes.
// All vectors are in the shading frame; wi, wo: unit vectors towards light and view.
#pragma once

#include <compare>
#include <cstddef>
#include <memory>
#include <variant>

#include <glm/vec2.hpp>

#include "shlight/types.h"

namespace shlight {

class LobeTable;

/// f·cos = cosθ_i / π.
struct LambertShape {
    bool is_glossy() const { return false; }
    double width() const { return 1; }
    double value(const Vec3d& wi, const Vec3d& wo) const;
    double albedo(double cos_theta_o) const;
    Vec3d sample(const Vec3d& wo, const glm::dvec2& point) const;
    double density(const Vec3d& wo, const Vec3d& wi) const;
    double largest_density(const Vec3d& wo) const;
    LambertShape sampled() const { return *this; }

    auto operator<=>(const LambertShape&) const = default;
};

/// Rough diffuse lobes.
enum class Diffuse {
    /// cosθ_i (1 + t), with t = ω_i·ω_o - cosθ_i cosθ_o, divided by max(cosθ_i, cosθ_o) where positive: the roughness
    /// term of Fujii's improved Oren–Nayar model (mimosa-pudica.net/improved-oren-nayar.html).
    oren_nayar,
    /// cosθ_i (π/2 - 2/3 - G(cosθ_i)): the energy that this model's first bounce loses and further bounces return.
    oren_nayar_loss,
    /// Lambert's lobe of a bumped normal, with ω_o the smooth normal, times the share that the smooth surface does not
    /// shadow: G₁ of GGX (Estevez, Lecocq & Stein 2019, "A Microfacet-Based Shadowing Function to Solve the Bump
    /// Terminator Problem").
    bumped_ggx,
    /// The same with the share -g³ + g² + g where g = ω_i·ω_o / (cosθ_i cosθ_o) is below 1 (Chiang, Li & Burley 2019,
    /// "Taming the Shadow Terminator").
    bumped_cubic
};

struct DiffuseShape {
    Diffuse kind;

    bool is_glossy() const { return false; }
    double width() const { return 1; }
    double value(const Vec3d& wi, const Vec3d& wo) const;
    double albedo(double cos_theta_o) const;
    LambertShape sampled() const { return {}; }

    // NOLINTNEXTLINE(modernize-use-nullptr): the linter misreads <=>
    auto operator<=>(const DiffuseShape&) const = default;
};

/// cosθ_i ((1 + ω_i·ω_o)ⁿ (base + light F_i + view F_o + both F_i F_o) / π + sheen (1 - cosθ_d)⁵), with F = (1 - cosθ)⁵
/// of light and view, and θ_d half the angle between them: parts of Disney's diffuse reflection (Burley 2015,
/// "Extending the Disney BRDF to a BSDF with Integrated Subsurface Scattering", Eq. 4) and its sheen (Burley 2012,
/// "Physically-Based Shading at Disney").
struct DisneyShape {
    double base = 0, light = 0, view = 0, both = 0;
    int power = 0;  ///< n, 0 … 2
    double sheen = 0;

    bool is_glossy() const { return false; }
    double width() const { return 1; }
    double value(const Vec3d& wi, const Vec3d& wo) const;
    double albedo(double cos_theta_o) const;
    LambertShape sampled() const { return {}; }

    // NOLINTNEXTLINE(modernize-use-nullptr): the linter misreads <=>
    auto operator<=>(const DisneyShape&) const = default;
};

/// These are multiplied with powers of the roughness, from the 0th on.
inline constexpr DisneyShape kDisneyDiffuse = {1, -0.5, -0.5, 0.25};
inline constexpr DisneyShape kDisneyRetro = {0, 1, 1, -1, 1};
inline constexpr DisneyShape kDisneyRetroSquare = {0, 0, 0, 1, 2};
/// kDisneyDiffuse without the factor of the view.
inline constexpr DisneyShape kDisneyEntry = {1, -0.5};
inline constexpr DisneyShape kDisneySheen = {0, 0, 0, 0, 0, 1};

/// The Fresnel factor of D G / (4 cosθ_i cosθ_o).
enum class Fresnel {
    one,         ///< 1: the part with factor f0, and metals without Fresnel
    schlick,     ///< (1 - cosθ_d)⁵: the part with factor 1 - f0
    dielectric,  ///< max(0, F(ior, cosθ_d) - F(ior, 1)) / (1 - F(ior, 1)): that part by the Fresnel equations
    dip,         ///< cosθ_d (1 - cosθ_d)⁶: reduction by metals' edge tint (Kutz, Hašan & Edmondson 2021)
    wide_dip,    ///< cosθ_d (1 - cosθ_d)³: with narrow_dip and the above it makes up Fresnel's curves of metals
    narrow_dip,  ///< cosθ_d (1 - cosθ_d)¹²
    broad_dip,   ///< cosθ_d (1 - cosθ_d)²: with linear and all of the above it makes up curves under thin films
    linear       ///< 1 - cosθ_d
};

/// The distribution of microfacets' normals, and their masking.
enum class Microfacets {
    ggx,       ///< height-correlated Smith masking (Heitz 2014)
    beckmann,  ///< the same with the rational approximation of Walter et al. 2007 to Λ, "Microfacet Models for
               ///< Refraction through Rough Surfaces"
    /// Without masking: f·cos = F (n+1)/8π cosⁿθ_h cosθ_i / (cosθ_d max(cosθ_i, cosθ_o)), n = 2/α² - 2 (Ashikhmin &
    /// Shirley 2000, "An Anisotropic Phong BRDF Model").
    ashikhmin_shirley
};

/// Microfacets, f·cos = F D G₂ / (4 cosθ_o).
/// A colour f0 needs two shapes: f0 · {one} + (1 - f0) · ({schlick or dielectric}) · …, see Bsdf::ggx.
/// Where `across` is not 0 the slopes of microfacets spread differently along two axes: the distribution is round in
/// (h_x/α_x, h_y/α_y, h_z) (Heitz 2014), and exponents of Ashikhmin & Shirley are interpolated as in their paper.
struct GgxShape {
    double alpha;                    ///< roughness² in Blender's terms, 0 … 1; 0 is a perfect mirror
    Fresnel fresnel = Fresnel::one;  ///< the factor included in f·cos
    double ior = 1.5;                ///< used by Fresnel::dielectric only
    Microfacets distribution = Microfacets::ggx;
    double across = 0;   ///< α at right angles to the axis that `alpha` is of, which is the smaller one; 0: the same
    double azimuth = 0;  ///< 0 … 2π: of ω_o about the normal, from that axis on

    bool is_glossy() const { return true; }
    double width() const { return alpha; }
    double value(const Vec3d& wi, const Vec3d& wo) const;
    double albedo(double cos_theta_o) const;
    /// Reflects ω_o at visible microfacets of GGX, whatever the distribution, which are spread the widest; normals have
    /// the density G₁ ⟨ω_o·h⟩ D / cosθ_o (Heitz 2018, "Sampling the GGX distribution of visible normals"; by spherical
    /// caps, Dupuy & Benyoub 2023). f·cos ÷ density is F G₂/G₁, which is bounded for all roughnesses and views.
    Vec3d sample(const Vec3d& wo, const glm::dvec2& point) const;
    double density(const Vec3d& wo, const Vec3d& wi) const;
    double largest_density(const Vec3d& wo) const;
    GgxShape sampled() const { return {alpha, Fresnel::one, 1.5, Microfacets::ggx, across, azimuth}; }

    // NOLINTNEXTLINE(modernize-use-nullptr): the linter misreads <=>
    auto operator<=>(const GgxShape&) const = default;
};

/// Blender's Toon BSDF: f·cos = I(θ) / 2π(1 - cos a) without a cosine, θ being the angle from the normal, or from the
/// mirror direction. I is 1 up to size · π/2 and falls linearly over smooth · π/2, to 0 unless it is cut at the angle
/// a = min(size + smooth, 1) π/2.
struct ToonShape {
    bool glossy;  ///< θ is from the mirror direction
    double size = 1, smooth = 0;

    bool is_glossy() const { return glossy; }
    double width() const;
    double value(const Vec3d& wi, const Vec3d& wo) const;
    double albedo(double cos_theta_o) const;
    /// Draws evenly from the cone of the angle a.
    Vec3d sample(const Vec3d& wo, const glm::dvec2& point) const;
    double density(const Vec3d& wo, const Vec3d& wi) const;
    double largest_density(const Vec3d& wo) const;
    ToonShape sampled() const { return *this; }

    // NOLINTNEXTLINE(modernize-use-nullptr): the linter misreads <=>
    auto operator<=>(const ToonShape&) const = default;
};

struct TableShape;

/// Rays are drawn from these; the other shapes name one of them as sampled().
using SampledShape = std::variant<LambertShape, GgxShape, ToonShape>;
using LobeShape = std::variant<LambertShape, DiffuseShape, DisneyShape, GgxShape, ToonShape, TableShape>;

/// A colour channel of a table, times cosθ_i.
struct TableShape {
    std::shared_ptr<const LobeTable> table;
    int channel = 0;
    double azimuth = 0;  ///< 0 … 2π: of ω_o about the normal, from the surface's tangent on; for anisotropic tables

    bool is_glossy() const;
    double width() const;
    double value(const Vec3d& wi, const Vec3d& wo) const;
    double albedo(double cos_theta_o) const;
    /// Lambert's lobe, or a GGX lobe whose tails reach what a table holds beside its peak.
    SampledShape sampled() const;

    // NOLINTNEXTLINE(modernize-use-nullptr): the linter misreads <=>
    auto operator<=>(const TableShape&) const = default;
};

/// Half width of the peak at the mirror direction [rad]; 1 for shapes without a peak.
double lobe_width(const LobeShape& shape);
/// Whether f·cos depends on the azimuth of ω_o from the surface's tangent on; toon, whose edges no two hits may share,
/// counts as such.
bool is_anisotropic(const LobeShape& shape);
/// Whether it is one of microfacets with two widths.
bool is_stretched(const LobeShape& shape);
/// Whether it is that or toon: two numbers vary from hit to hit, and there are no fits.
bool has_two_widths(const LobeShape& shape);
/// Whether it is Lambert's lobe of a bumped normal, whose ω_o is a normal.
bool is_bumped(const LobeShape& shape);
/// Lanes take this number of each view: the azimuth of an anisotropic table, or the width of another shape.
double lobe_parameter(const LobeShape& shape);

/// These numbers may differ from hit to hit: members of GgxShape, those of ToonShape as width and across, or the
/// azimuth of an anisotropic table.
struct LobeForm {
    float width = 1, across = 0, azimuth = 0;
};
LobeForm lobe_form(const LobeShape& shape);
/// The shape with another form; what a shape does not have is left out.
LobeShape with_form(const LobeShape& shape, const LobeForm& form);
/// The shape at another azimuth, if it has one.
LobeShape with_azimuth(const LobeShape& shape, double azimuth);
/// The shape with another width; unchanged if it has only one.
LobeShape with_width(const LobeShape& shape, double width);
/// The form of microfacets that are at least so wide; unchanged if the shape is another's.
LobeForm widened(const LobeShape& shape, const LobeForm& form, double least_width);
/// Whether the shape has a peak: it is then shaded in a boosted frame, and lights may exclude it ("visible to glossy
/// rays").
bool is_glossy(const LobeShape& shape);
/// Whether the width is 0: all light comes from one direction, and f·cos is 0 elsewhere.
bool is_mirror(const LobeShape& shape);
/// The mirror direction of a view in the xz-plane.
inline Vec3d mirrored(const Vec3d& wo) {
    return {-wo.x, 0, wo.z};
}

/// f·cos; 0 where either direction lies below the horizon.
double lobe_value(const LobeShape& shape, const Vec3d& wi, const Vec3d& wo);
/// f·cos for many directions (x[i], y[i], z[i]); 0 for a mirror.
void lobe_values(const LobeShape& shape, const double* x, const double* y, const double* z, std::size_t count,
                 const Vec3d& wo, float* values);
/// ∫ f·cos dω, by cubature unless a closed form is known.
double lobe_albedo(const LobeShape& shape, double cos_theta_o);

/// Maps a point of (0 … 1)² to a unit direction ω_i that the lobe reflects towards ω_o; the map is continuous except at
/// one line. ω_i may lie below the horizon. wo: above the horizon, in the xz-plane. A mirror has only one direction.
Vec3d sample_lobe(const LobeShape& shape, const Vec3d& wo, const glm::dvec2& point);
/// Density of sample_lobe() per solid angle, 0 below the horizon, and its maximum. Precondition: not a mirror.
double lobe_density(const LobeShape& shape, const Vec3d& wo, const Vec3d& wi);
double largest_lobe_density(const LobeShape& shape, const Vec3d& wo);
/// The simplest shape with the same density; lobes for which it is equal can share their sampled directions.
LobeShape sampled_shape(const LobeShape& shape);

}  // namespace shlight
