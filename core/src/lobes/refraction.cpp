// SPDX-License-Identifier: MIT
#include "lobes/refraction.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "shlight/lobe_shape.h"

namespace shlight {
namespace {

/// G₂ ÷ G₁ of the viewer's side: the share of microfacets that the other direction sees. cosine: of that direction.
double seen_share(double alpha, double cosine) {
    const double square = cosine * cosine;
    return 2 / (1 + std::sqrt(1 + alpha * alpha * (1 - square) / square));
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

InterfaceRay sample_interface(double alpha, double ior, const Vec3d& view, const glm::dvec2& point,
                              InterfaceReflection reflection, double choice) {
    const Vec3d mirrored_way = sample_lobe(GgxShape{alpha}, view, point);
    const Vec3d normal = glm::normalize(view + mirrored_way);
    const double cosine = std::min(glm::dot(view, normal), 1.0);
    const double reflectance = interface_reflectance(cosine, ior);
    if (reflection == InterfaceReflection::drawn && choice < reflectance) {
        const bool above = mirrored_way.z > 0;
        return {mirrored_way, above ? seen_share(alpha, mirrored_way.z) : 0.0, true};
    }
    const double inside = 1 - (1 - cosine * cosine) / (ior * ior);
    if (inside <= 0) {
        return {};
    }
    const Vec3d way = (cosine / ior - std::sqrt(inside)) * normal - view / ior;
    const double passed = reflection == InterfaceReflection::apart ? 1 - reflectance : 1.0;
    return {way, way.z < 0 ? passed * seen_share(alpha, way.z) : 0.0, false};
}

}  // namespace shlight
