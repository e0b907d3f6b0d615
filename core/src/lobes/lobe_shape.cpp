// SPDX-License-Identifier: MIT
#include "shlight/lobe_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shlight {
namespace {

/// Unpolarised Fresnel reflectance at a dielectric of relative index ior ≥ 1, from outside.
double fresnel_dielectric(double cosine, double ior) {
    const double g = std::sqrt(ior * ior - 1 + cosine * cosine);
    const double a = (g - cosine) / (g + cosine);
    const double b = (cosine * (g + cosine) - 1) / (cosine * (g - cosine) + 1);
    return 0.5 * a * a * (1 + b * b);
}

double value(const LambertShape&, const Vec3d& wi, const Vec3d&) {
    return wi.z / std::numbers::pi;
}

/// With D = α² / (π ((α²-1) cos²θ_h + 1)²) and G₂ / (4 cosθ_i cosθ_o)
/// = ½ / (cosθ_o √(α² + (1-α²) cos²θ_i) + cosθ_i √(α² + (1-α²) cos²θ_o)), finite at grazing angles.
double value(const GgxShape& shape, const Vec3d& wi, const Vec3d& wo) {
    const double a2 = shape.alpha * shape.alpha;
    const Vec3d sum = wi + wo;
    const double length = glm::length(sum);
    if (!(length > 0)) {
        return 0;
    }
    const Vec3d h = sum / length;
    // 1 - cos²θ_h as sin²θ_h: the peak of a narrow lobe hangs on it.
    const double bell = a2 * h.z * h.z + (h.x * h.x + h.y * h.y);
    const double density = a2 / (std::numbers::pi * bell * bell);
    const double visibility =
        0.5 / (wo.z * std::sqrt(a2 + (1 - a2) * wi.z * wi.z) + wi.z * std::sqrt(a2 + (1 - a2) * wo.z * wo.z));
    const double cosine = std::clamp(glm::dot(wi, h), 0.0, 1.0);
    return fresnel_factor(shape, cosine) * density * visibility * wi.z;
}

}  // namespace

double fresnel_factor(const GgxShape& shape, double cosine) {
    switch (shape.fresnel) {
        case Fresnel::one:
            return 1;
        case Fresnel::schlick: {
            const double edge = 1 - cosine;
            return edge * edge * edge * edge * edge;
        }
        case Fresnel::dielectric: {
            const double head_on = fresnel_dielectric(1, shape.ior);
            return (fresnel_dielectric(cosine, shape.ior) - head_on) / (1 - head_on);
        }
    }
    return 0;
}

double lobe_value(const LobeShape& shape, const Vec3d& wi, const Vec3d& wo) {
    if (!(wi.z > 0 && wo.z > 0) || is_mirror(shape)) {
        return 0;
    }
    return std::visit([&](const auto& s) { return value(s, wi, wo); }, shape);
}

}  // namespace shlight
