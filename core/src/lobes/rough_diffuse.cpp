// SPDX-License-Identifier: MIT
//
// Rough diffuse lobes, one direction at a time. All draw rays with Lambert's density.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "lobes/boundary_integral.h"
#include "lobes/rough_diffuse.h"
#include "regions/boundary.h"
#include "shlight/lobe_shape.h"

namespace shlight {
namespace {

using std::numbers::pi;

/// Absolute error of the albedo, which is integrated along the horizon.
constexpr double kDiffuseAlbedoTolerance = 1e-5;

/// Oren–Nayar's s/t: the product of both directions' tangential parts, divided by the larger cosine where positive.
double agreement(const Vec3d& wi, const Vec3d& wo) {
    const double t = wi.x * wo.x + wi.y * wo.y;
    return t > 0 ? t / std::max(wi.z, wo.z) : t;
}

/// G₁ of GGX, 2 / (1 + √(1 + α² tan²θ)), with α² = tan²θ_o / 8 and θ the angle between light and ω_o.
double bump_shadow(const Vec3d& wi, const Vec3d& wo) {
    const double cosine = glm::dot(wi, wo);
    if (!(cosine > 0)) {
        return 0;
    }
    const double alpha2 = std::min(kBumpShare * (1 - wo.z * wo.z) / (wo.z * wo.z), 1.0);
    const double square = cosine * cosine;
    return 2 * cosine / (cosine + std::sqrt(square + alpha2 * std::max(1 - square, 0.0)));
}

}  // namespace

double oren_nayar_loss(double cosine) {
    // At grazing angles the quotient would cancel; its series is used there.
    const double edge = pi / 2 - 2.0 / 3;
    if (cosine < kGrazingLoss) {
        return cosine;
    }
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const double g = sine * (std::acos(std::min(cosine, 1.0)) - 2.0 / 3 - sine * cosine) +
                     2.0 / 3 * (sine / cosine) * (1 - sine * sine * sine);
    return edge - g;
}

double DiffuseShape::value(const Vec3d& wi, const Vec3d& wo) const {
    switch (kind) {
        case Diffuse::oren_nayar:
            return wi.z * (1 + agreement(wi, wo));
        case Diffuse::oren_nayar_loss:
            return wi.z * oren_nayar_loss(wi.z);
        case Diffuse::bumped:
            return wi.z / pi * bump_shadow(wi, wo);
    }
    return 0;
}

double DiffuseShape::albedo(double cos_theta_o) const {
    const Arc<double> horizon = whole_circle({{0, 0, 1}, 0, 1});
    return boundary_integral(*this, cos_theta_o, {&horizon, 1}, kDiffuseAlbedoTolerance).value;
}

Vec3d DiffuseShape::sample(const Vec3d& wo, const glm::dvec2& point) const {
    return LambertShape().sample(wo, point);
}

double DiffuseShape::density(const Vec3d& wo, const Vec3d& wi) const {
    return LambertShape().density(wo, wi);
}

double DiffuseShape::largest_density(const Vec3d& wo) const {
    return LambertShape().largest_density(wo);
}

}  // namespace shlight
