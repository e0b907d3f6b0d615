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
        case Fresnel::broad_dip:
            return cosine * (1 - cosine) * (1 - cosine);
        case Fresnel::linear:
            return 1 - cosine;
        case Fresnel::dielectric: {
            const double head_on = interface_reflectance(1, shape.ior);
            return std::max(0.0, (interface_reflectance(cosine, shape.ior) - head_on) / (1 - head_on));
        }
    }
    return 0;
}

/// A lobe's axes, in which vectors are given to its members.
class LobeAxes {
  public:
    explicit LobeAxes(const GgxShape& shape)
        : x_(shape.alpha),
          y_(shape.across != 0 ? shape.across : shape.alpha),
          cosine_(std::cos(shape.azimuth)),
          sine_(std::sin(shape.azimuth)) {}

    /// A vector of the view's frame.
    Vec3d turned(const Vec3d& v) const { return {cosine_ * v.x - sine_ * v.y, sine_ * v.x + cosine_ * v.y, v.z}; }
    Vec3d turned_back(const Vec3d& v) const { return {cosine_ * v.x + sine_ * v.y, cosine_ * v.y - sine_ * v.x, v.z}; }
    Vec3d stretched(const Vec3d& v) const { return {x_ * v.x, y_ * v.y, v.z}; }
    Vec3d shrunk(const Vec3d& v) const { return {v.x / x_, v.y / y_, v.z}; }
    double x() const { return x_; }
    double y() const { return y_; }

    /// √(cos²θ + α_x² x² + α_y² y²) of a unit vector.
    double masking(const Vec3d& v) const { return glm::length(stretched(v)); }
    /// D at the half vector of s = ω_i + ω_o. It uses sin²θ_h, since 1 - cos²θ_h would lose the digits that decide the
    /// peak of a narrow lobe.
    double distribution(const Vec3d& sum) const {
        const Vec3d round = shrunk(sum);
        const double ratio = glm::dot(sum, sum) / glm::dot(round, round);
        return ratio * ratio / (pi * x_ * y_);
    }
    /// G₁ / (4 cosθ_o) with G₁ = 2 cosθ_o / (cosθ_o + masking): cosθ_o cancels, so grazing angles are finite.
    double visible_share(const Vec3d& wo) const { return 0.5 / (wo.z + masking(wo)); }
    /// cosθ (1 + 2 Λ) of Beckmann's distribution.
    double beckmann_masking(const Vec3d& v) const {
        return v.z + 2 * beckmann_hidden(std::hypot(x_ * v.x, y_ * v.y), v.z);
    }

  private:
    double x_, y_;  // α
    double cosine_, sine_;
};

/// f·cos ÷ Fresnel's factor, for distributions other than GGX. cosine: ω_i·h.
double other_microfacets(const GgxShape& shape, const LobeAxes& axes, const Vec3d& wi, const Vec3d& wo, double cosine) {
    const Vec3d sum = wi + wo;
    const Vec3d round = axes.shrunk(sum);
    const double tangent2 = (sum.x * sum.x + sum.y * sum.y) / (sum.z * sum.z);
    const double slope2 = (round.x * round.x + round.y * round.y) / (sum.z * sum.z);
    const double a2 = axes.x() * axes.y();
    if (shape.distribution == Microfacets::ashikhmin_shirley) {
        const double norm = std::sqrt((2 / (axes.x() * axes.x()) - 1) * (2 / (axes.y() * axes.y()) - 1)) / (8 * pi);
        const double power = tangent2 > 0 ? slope2 / tangent2 - 1 : 0;
        const double lobe = norm * std::exp(-power * std::log1p(tangent2));
        return lobe * wi.z / (cosine * std::max(wi.z, wo.z));
    }
    const double spread = std::exp(-slope2) * (1 + tangent2) * (1 + tangent2) / (pi * a2);
    return 0.5 * spread * wi.z / (wo.z * axes.beckmann_masking(wi) + wi.z * axes.beckmann_masking(wo));
}

}  // namespace

/// GGX has F D G₂ / (4 cosθ_o) with D = 1 / (π α_x α_y |(h_x/α_x, h_y/α_y, h_z)|⁴) and G₂ / (4 cosθ_i cosθ_o) = ½ /
/// (cosθ_o masking(ω_i) + cosθ_i masking(ω_o)), which is finite at grazing angles.
double GgxShape::value(const Vec3d& wi, const Vec3d& wo) const {
    const LobeAxes axes(*this);
    const Vec3d in = axes.turned(wi);
    const Vec3d out = axes.turned(wo);
    const Vec3d sum = in + out;
    const double square = glm::dot(sum, sum);
    if (!(square > 0)) {
        return 0;
    }
    const double cosine = std::min(1.0, std::sqrt(square) / 2);  // ω_i·h
    if (distribution != Microfacets::ggx) {
        return fresnel_factor(*this, cosine) * other_microfacets(*this, axes, in, out, cosine);
    }
    const double visibility = 0.5 / (out.z * axes.masking(in) + in.z * axes.masking(out));
    return fresnel_factor(*this, cosine) * axes.distribution(sum) * visibility * in.z;
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
    const LobeAxes axes(*this);
    const Vec3d out = axes.turned(wo);
    const Vec3d view = glm::normalize(axes.stretched(out));
    const double z = (1 - point.y) * (1 + view.z) - view.z;
    const double sine = std::sqrt(std::max(0.0, (1 - z) * (1 + z)));
    const double turn = 2 * pi * point.x;
    const Vec3d h = Vec3d(sine * std::cos(turn), sine * std::sin(turn), z) + view;
    const Vec3d normal = glm::normalize(axes.stretched(h));
    return axes.turned_back(glm::normalize(2 * glm::dot(out, normal) * normal - out));
}

double GgxShape::density(const Vec3d& wo, const Vec3d& wi) const {
    const LobeAxes axes(*this);
    return axes.visible_share(axes.turned(wo)) * axes.distribution(axes.turned(wi + wo));
}

double GgxShape::largest_density(const Vec3d& wo) const {
    const LobeAxes axes(*this);
    return axes.visible_share(axes.turned(wo)) / (pi * axes.x() * axes.y());
}

}  // namespace shlight
