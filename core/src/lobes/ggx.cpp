// SPDX-License-Identifier: MIT
//
// Lobes of microfacets, one direction at a time.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "lobes/boundary_integral.h"
#include "lobes/microfacets.h"
#include "lobes/refraction.h"
#include "regions/boundary.h"
#include "shlight/lobe_shape.h"

namespace shlight {
namespace {

using std::numbers::pi;

/// Absolute error of the albedo, which is integrated along the horizon.
constexpr double kAlbedoTolerance = 1e-5;

/// Fresnel factor at ω_i·h = cosine.
double fresnel_factor(const GgxShape& shape, double cosine) {
    switch (shape.fresnel) {
        case Fresnel::one:
            return 1;
        case Fresnel::schlick: {
            const double edge = 1 - cosine;
            return edge * edge * edge * edge * edge;
        }
        case Fresnel::dip:
            return cosine * std::pow(1 - cosine, 6);
        case Fresnel::wide_dip:
            return cosine * std::pow(1 - cosine, 3);
        case Fresnel::narrow_dip:
            return cosine * std::pow(1 - cosine, 12);
        case Fresnel::dielectric: {
            const double head_on = interface_reflectance(1, shape.ior);
            return std::max(0.0, (interface_reflectance(cosine, shape.ior) - head_on) / (1 - head_on));
        }
    }
    return 0;
}

/// √(α² + (1-α²) cos²θ).
double masking(double a2, double cosine) {
    return std::sqrt(a2 + (1 - a2) * cosine * cosine);
}

/// √(π α² D) = α² |s|² / (α² s_z² + s_x² + s_y²) of s = ω_i + ω_o. It uses sin²θ_h, since 1 - cos²θ_h would lose the
/// digits that decide the peak of a narrow lobe.
double sharpness(double a2, const Vec3d& sum) {
    return a2 * glm::dot(sum, sum) / (a2 * sum.z * sum.z + (sum.x * sum.x + sum.y * sum.y));
}

/// G₁ / (4 cosθ_o) with G₁ = 2 cosθ_o / (cosθ_o + masking): cosθ_o cancels, so grazing angles are finite.
double visible_share(double a2, double cos_theta_o) {
    return 0.5 / (cos_theta_o + masking(a2, cos_theta_o));
}

/// cosθ (1 + 2 Λ) of Beckmann's distribution, with Λ = 0 where tanθ < 1/(1.6 α); as a quotient it is finite for grazing
/// angles.
double beckmann_masking(double alpha, double cosine) {
    const double across = alpha * std::sqrt(std::max(0.0, 1 - cosine * cosine));
    if (cosine >= kUnmasked * across) {
        return cosine;
    }
    const double a = cosine / across;
    return cosine + 2 * across * ((0.396 * a - 1.259) * a + 1) / (2.181 * a + 3.535);
}

/// f·cos ÷ Fresnel's factor, for distributions other than GGX. tangent2: tan²θ_h; cosine: ω_i·h.
double other_microfacets(const GgxShape& shape, double tangent2, double cosine, double cos_i, double cos_o) {
    const double a2 = shape.alpha * shape.alpha;
    if (shape.distribution == Microfacets::ashikhmin_shirley) {
        const double lobe = (2 / a2 - 1) / (8 * pi) * std::exp(-(1 / a2 - 1) * std::log1p(tangent2));
        return lobe * cos_i / (cosine * std::max(cos_i, cos_o));
    }
    const double spread = std::exp(-tangent2 / a2) * (1 + tangent2) * (1 + tangent2) / (pi * a2);
    return 0.5 * spread * cos_i /
           (cos_o * beckmann_masking(shape.alpha, cos_i) + cos_i * beckmann_masking(shape.alpha, cos_o));
}

}  // namespace

/// GGX has F D G₂ / (4 cosθ_o) with D = α² / (π ((α²-1) cos²θ_h + 1)²) and G₂ / (4 cosθ_i cosθ_o) = ½ / (cosθ_o
/// √(α² + (1-α²) cos²θ_i) + cosθ_i √(α² + (1-α²) cos²θ_o)), which is finite at grazing angles.
double GgxShape::value(const Vec3d& wi, const Vec3d& wo) const {
    const double a2 = alpha * alpha;
    const Vec3d sum = wi + wo;
    const double square = glm::dot(sum, sum);
    if (!(square > 0)) {
        return 0;
    }
    const double cosine = std::min(1.0, std::sqrt(square) / 2);  // ω_i·h
    if (distribution != Microfacets::ggx) {
        const double tangent2 = (sum.x * sum.x + sum.y * sum.y) / (sum.z * sum.z);
        return fresnel_factor(*this, cosine) * other_microfacets(*this, tangent2, cosine, wi.z, wo.z);
    }
    const double ratio = sharpness(a2, sum);
    const double visibility = 0.5 / (wo.z * masking(a2, wi.z) + wi.z * masking(a2, wo.z));
    return fresnel_factor(*this, cosine) * ratio * ratio / (pi * a2) * visibility * wi.z;
}

double GgxShape::albedo(double cos_theta_o) const {
    if (alpha == 0) {
        return fresnel_factor(*this, cos_theta_o);
    }
    const Arc<double> horizon = whole_circle({{0, 0, 1}, 0, 1});
    return boundary_integral(*this, cos_theta_o, {&horizon, 1}, kAlbedoTolerance).value;
}

Vec3d GgxShape::sample(const Vec3d& wo, const glm::dvec2& point) const {
    // Visible normals by spherical caps (Dupuy & Benyoub 2023): stretched by 1/α the microfacets are a hemisphere,
    // which reflects parallel light evenly into the cap z > -cosine of the view.
    const Vec3d view = glm::normalize(Vec3d(alpha * wo.x, alpha * wo.y, wo.z));
    const double z = (1 - point.y) * (1 + view.z) - view.z;
    const double sine = std::sqrt(std::max(0.0, (1 - z) * (1 + z)));
    const double azimuth = 2 * pi * point.x;
    const Vec3d h = Vec3d(sine * std::cos(azimuth), sine * std::sin(azimuth), z) + view;
    const Vec3d normal = glm::normalize(Vec3d(alpha * h.x, alpha * h.y, h.z));
    return glm::normalize(2 * glm::dot(wo, normal) * normal - wo);
}

double GgxShape::density(const Vec3d& wo, const Vec3d& wi) const {
    const double a2 = alpha * alpha;
    const double ratio = sharpness(a2, wi + wo);
    return visible_share(a2, wo.z) * ratio * ratio / (pi * a2);
}

double GgxShape::largest_density(const Vec3d& wo) const {
    return visible_share(alpha * alpha, wo.z) / (pi * alpha * alpha);
}

}  // namespace shlight
