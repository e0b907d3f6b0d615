// SPDX-License-Identifier: MIT
//
// Scalar lobe shapes f·cos: a BRDF times the cosine at the light's side, isotropic, without colour.
#pragma once

#include <compare>
#include <variant>

#include "shlight/types.h"

namespace shlight {

/// f·cos = cosθ_i / π.
struct LambertShape {
    auto operator<=>(const LambertShape&) const = default;
};

/// What multiplies D G / (4 cosθ_i cosθ_o).
enum class Fresnel {
    one,        ///< 1: the part that f0 scales, and metals without Fresnel
    schlick,    ///< (1 - cosθ_d)⁵: the part that 1 - f0 scales
    dielectric  ///< (F(ior, cosθ_d) - F(ior, 1)) / (1 - F(ior, 1)): the same from the exact Fresnel equations
};

/// GGX with height-correlated Smith masking (Heitz 2014), f·cos = F D G₂ / (4 cosθ_o).
/// A colour f0 needs two shapes: f0 · {one} + (1 - f0) · ({schlick or dielectric}) · …, see Bsdf::ggx.
struct GgxShape {
    double alpha;                    ///< roughness² in Blender's terms, 0 … 1; 0 is a perfect mirror
    Fresnel fresnel = Fresnel::one;  ///< which factor is folded in
    double ior = 1.5;                ///< used by Fresnel::dielectric only
    // NOLINTNEXTLINE(modernize-use-nullptr): the linter misreads <=>
    auto operator<=>(const GgxShape&) const = default;
};

/// The factor at ω_i·h = cosine.
double fresnel_factor(const GgxShape& shape, double cosine);

using LobeShape = std::variant<LambertShape, GgxShape>;

/// A perfect mirror: all of its light comes from one direction, and f·cos is 0 everywhere else.
inline bool is_mirror(const LobeShape& shape) {
    const auto* ggx = std::get_if<GgxShape>(&shape);
    return ggx != nullptr && ggx->alpha == 0;
}

/// f·cos in the shading frame; wi, wo unit vectors; 0 where either lies below the horizon.
double lobe_value(const LobeShape& shape, const Vec3d& wi, const Vec3d& wo);

}  // namespace shlight
