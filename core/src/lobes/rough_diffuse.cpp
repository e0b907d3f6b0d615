// SPDX-License-Identifier: MIT
//
// Rough diffuse lobes and Disney's, one direction at a time.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "lobes/rough_diffuse.h"
#include "math/gauss_legendre.h"
#include "shlight/lobe_shape.h"

namespace shlight {
namespace {

using std::numbers::pi;

/// Oren–Nayar's s/t: the product of both directions' tangential parts, divided by the larger cosine where positive.
double agreement(const Vec3d& wi, const Vec3d& wo) {
    const double t = wi.x * wo.x + wi.y * wo.y;
    return t > 0 ? t / std::max(wi.z, wo.z) : t;
}

/// G₁ of GGX, 2 / (1 + √(1 + α² tan²θ)), with α² = tan²θ_o / 8 and θ the angle between light and ω_o, whose cosine is
/// given.
double bump_shadow(double cosine, double cos_theta_o) {
    if (!(cosine > 0)) {
        return 0;
    }
    const double z2 = cos_theta_o * cos_theta_o;
    const double alpha2 = std::min(kBumpShare * (1 - z2) / z2, 1.0);
    const double square = cosine * cosine;
    return 2 * cosine / (cosine + std::sqrt(square + alpha2 * std::max(1 - square, 0.0)));
}

/// The share of light that a bump does not shadow, of the quotient of the light's and the bump's cosines.
double cubic_bump_shadow(double g) {
    const double clamped = std::clamp(g, 0.0, 1.0);
    return clamped * (1 + clamped * (1 - clamped));
}

/// ∫ f·cos dω of Diffuse::bumped_cubic. In the plane of both normals g is 1 + tanψ tanθ_o, ψ being the angle from the
/// bump's normal, wherever ω_i lies across that plane; with t = -tanψ tanθ_o it is ½ ∫ cosψ (1 - 2t² + t³) dψ.
double cubic_bump_albedo(double cos_theta_o) {
    const double c = cos_theta_o, s = std::sqrt(std::max(0.0, 1 - c * c));
    if (s == 0) {
        return 1;
    }
    const double square = s * s / (c * c);
    return (1 + c - 2 * square * (std::asinh(c / s) - c) + square / c * (1 - s) * (1 - s)) / 2;
}

/// ∫ max(0, cosθ_i) dφ along the circle of directions at an angle to ω_o, whose cosine is given.
double light_on_circle(double cosine, const Vec3d& wo) {
    const double mean = cosine * wo.z, swing = std::sqrt(1 - cosine * cosine) * wo.x;
    if (mean >= swing) {
        return 2 * pi * mean;
    }
    const double end = std::acos(-mean / swing);
    return 2 * (mean * end + swing * std::sin(end));
}

/// ∫ f·cos dω to 1e-6 of an f that depends on the angle between ω_i and ω_o alone, by circles around ω_o: those that
/// cross the horizon, up to sinθ_o, and the others. f takes the cosine; it is 0 where that is below `least`, 0 or -1.
template <class Function>
double albedo_by_circles(double cos_theta_o, double least, const Function& f) {
    const Vec3d wo(std::sqrt(std::max(0.0, 1 - cos_theta_o * cos_theta_o)), 0, cos_theta_o);
    const auto reflected = [&](double cosine) { return f(cosine) * light_on_circle(cosine, wo); };
    constexpr int kPoints = 12;
    const GaussRule& rule = gauss_rule(kPoints);
    const double begin = least * wo.x;
    const double length = wo.x - begin;
    double sum = 0;
    for (std::size_t i = 0; i < kPoints; ++i) {
        const double x = rule.nodes[i];
        // The cubic evens out the roots at both ends.
        const double crossing = begin + length * x * x * (3 - 2 * x);
        sum += rule.weights[i] *
               (6 * length * x * (1 - x) * reflected(crossing) + (1 - wo.x) * reflected(wo.x + (1 - wo.x) * x));
    }
    return sum;
}

/// (1 - cosine)⁵
double rise(double cosine) {
    return std::pow(1 - cosine, 5);
}

/// cosθ_d of the angle between ω_i and ω_o, whose cosine is given.
double half_angle_cosine(double cosine) {
    return std::sqrt(std::max(0.0, (1 + cosine) / 2));
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
        case Diffuse::bumped_ggx:
            return wi.z / pi * bump_shadow(glm::dot(wi, wo), wo.z);
        case Diffuse::bumped_cubic:
            return wi.z / pi * cubic_bump_shadow(glm::dot(wi, wo) / (wi.z * wo.z));
    }
    return 0;
}

/// The integral of Oren–Nayar's s/t is G of Fujii's model, and what G loses over all views π (6/5 - π/6).
double DiffuseShape::albedo(double cos_theta_o) const {
    switch (kind) {
        case Diffuse::oren_nayar:
            return pi + (pi / 2 - 2.0 / 3) - oren_nayar_loss(cos_theta_o);
        case Diffuse::oren_nayar_loss:
            return pi * (6.0 / 5 - pi / 6);
        case Diffuse::bumped_ggx:
            return albedo_by_circles(cos_theta_o, 0,
                                     [&](double cosine) { return bump_shadow(cosine, cos_theta_o) / pi; });
        case Diffuse::bumped_cubic:
            return cubic_bump_albedo(cos_theta_o);
    }
    return 0;
}

double DisneyShape::value(const Vec3d& wi, const Vec3d& wo) const {
    const double between = glm::dot(wi, wo);
    const double light_rise = rise(wi.z);
    const double view_rise = rise(wo.z);
    const double flat = base + light * light_rise + view * view_rise + both * light_rise * view_rise;
    return wi.z * (flat * std::pow(1 + between, power) / pi + sheen * rise(half_angle_cosine(between)));
}

/// The mean of (1 + ω_i·ω_o)ⁿ along a circle cosθ_i = c is a polynomial of c, and ∫ cᵏ (1 - c)⁵ dc = k! 5! / (k + 6)!.
double DisneyShape::albedo(double cos_theta_o) const {
    const double c = cos_theta_o;
    const double half_sin2 = (1 - c * c) / 2;
    const std::array<std::array<double, 3>, 3> means = {
        {{1, 0, 0}, {1, c, 0}, {1 + half_sin2, 2 * c, c * c - half_sin2}}};
    constexpr std::array<double, 3> kRises = {1.0 / 42, 1.0 / 168, 1.0 / 504};
    const double constant = base + view * rise(c);
    const double slope = light + both * rise(c);
    double sum = 0;
    for (std::size_t k = 0; k < kRises.size(); ++k) {
        sum += 2 * means[static_cast<std::size_t>(power)][k] *
               (constant / (static_cast<double>(k) + 2) + slope * kRises[k]);
    }
    const auto fuzz = [](double cosine) { return rise(half_angle_cosine(cosine)); };
    return sheen != 0 ? sum + sheen * albedo_by_circles(c, -1, fuzz) : sum;
}

}  // namespace shlight
