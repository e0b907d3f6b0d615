// SPDX-License-Identifier: MIT
#include "lobes/refraction.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "lobes/microfacets.h"
#include "shlight/lobe_shape.h"

namespace shlight {
namespace {

/// Smith's Λ of GGX.
double hidden(double alpha, double cosine) {
    const double square = cosine * cosine;
    return (std::sqrt(1 + alpha * alpha * (1 - square) / square) - 1) / 2;
}

/// G₂ ÷ G₁ of the viewer's side, with masking and shadowing by the same heights (Heitz 2014).
double seen_share(double alpha, double view_cosine, double cosine) {
    const double seen = 1 + hidden(alpha, view_cosine);
    return seen / (seen + hidden(alpha, cosine));
}

/// The same with D G₂ of the interface's distribution ÷ D G₁ of GGX, by whose visible normals rays are drawn.
double seen_share(const RoughInterface& interface, const Vec3d& half, double view_cosine, double cosine) {
    const double alpha = interface.alpha;
    if (interface.distribution == Microfacets::ggx || alpha == 0) {
        return seen_share(alpha, view_cosine, cosine);
    }
    const double steepest = 100;  // of which there are next to none
    const double slope = std::min((half.x * half.x + half.y * half.y) / (half.z * half.z * alpha * alpha), steepest);
    const double normals = std::exp(-slope) * (1 + slope) * (1 + slope);
    double both = 1;
    for (const double side : {view_cosine, std::abs(cosine)}) {
        both += beckmann_hidden(alpha * std::sqrt(std::max(1 - side * side, 0.0)), side) / side;
    }
    return normals * (1 + hidden(alpha, view_cosine)) / both;
}

}  // namespace

double interface_reflectance(double cosine, double ior) {
    const double square = ior * ior - 1 + cosine * cosine;
    if (square <= 0) {
        return 1;
    }
    const double g = std::sqrt(square);
    const double a = (g - cosine) / (g + cosine);
    const double b = (cosine * (g + cosine) - 1) / (cosine * (g - cosine) + 1);
    return 0.5 * a * a * (1 + b * b);
}

InterfaceValue interface_value(const RoughInterface& interface, const Vec3d& view, const Vec3d& way) {
    const auto& [alpha, ior, reflection, distribution] = interface;
    const bool reflected = way.z > 0;
    const Vec3d sum = reflected ? view + way : view + ior * way;
    const Vec3d half = glm::normalize(sum.z < 0 ? -sum : sum);
    const double cosine = glm::dot(view, half);
    const double beyond = -glm::dot(way, half);
    const double reflectance = interface_reflectance(std::abs(cosine), ior);
    const double passed = reflection == InterfaceReflection::none && reflectance < 1 ? 1.0 : 1 - reflectance;
    const double drawn = reflection == InterfaceReflection::drawn ? reflectance : 0.0;
    // The sine is used, since 1 - cos² would lose the digits that decide the peak of a narrow lobe.
    const double across = half.x * half.x + half.y * half.y + alpha * alpha * half.z * half.z;
    const double normals = alpha * alpha / (std::numbers::pi * across * across);
    const double visible = normals / (1 + hidden(alpha, view.z)) / view.z;
    const double spread = reflected ? 0.25 : std::abs(cosine * ior * ior * beyond) / glm::dot(sum, sum);
    const double value = (reflected ? drawn : passed) * visible * seen_share(interface, half, view.z, way.z) * spread;
    const double chosen = reflected                                  ? drawn
                          : reflection == InterfaceReflection::drawn ? passed
                          : reflectance < 1                          ? 1.0
                                                                     : 0.0;
    const bool is_drawn = cosine > 0 && (beyond > 0) != reflected;
    return {value, is_drawn ? chosen * visible * spread : 0.0};
}

InterfaceRay sample_interface(const RoughInterface& interface, const Vec3d& view, const glm::dvec2& point,
                              double choice) {
    const auto& [alpha, ior, reflection, distribution] = interface;
    const Vec3d mirrored_way = sample_lobe(GgxShape{alpha}, view, point);
    const Vec3d normal = glm::normalize(view + mirrored_way);
    const double cosine = std::min(glm::dot(view, normal), 1.0);
    const double reflectance = interface_reflectance(cosine, ior);
    if (reflection == InterfaceReflection::drawn && choice < reflectance) {
        const bool above = mirrored_way.z > 0;
        return {mirrored_way, above ? seen_share(interface, normal, view.z, mirrored_way.z) : 0.0, true};
    }
    const double inside = 1 - (1 - cosine * cosine) / (ior * ior);
    if (inside <= 0) {
        return {};
    }
    const Vec3d way = (cosine / ior - std::sqrt(inside)) * normal - view / ior;
    const double passed = reflection == InterfaceReflection::apart ? 1 - reflectance : 1.0;
    return {way, way.z < 0 ? passed * seen_share(interface, normal, view.z, way.z) : 0.0, false};
}

}  // namespace shlight
