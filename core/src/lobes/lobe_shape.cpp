// SPDX-License-Identifier: MIT
#include "shlight/lobe_shape.h"

#include "shlight/lobe_table.h"

namespace shlight {

double lobe_width(const LobeShape& shape) {
    return std::visit([](const auto& s) { return s.width(); }, shape);
}

bool is_anisotropic(const LobeShape& shape) {
    const auto* own = std::get_if<TableShape>(&shape);
    return own != nullptr && !own->table->is_isotropic();
}

double lobe_parameter(const LobeShape& shape) {
    return is_anisotropic(shape) ? std::get<TableShape>(shape).azimuth : lobe_width(shape);
}

LobeShape with_parameter(const LobeShape& shape, double parameter) {
    if (!is_anisotropic(shape)) {
        return with_width(shape, parameter);
    }
    LobeShape result = shape;
    std::get<TableShape>(result).azimuth = parameter;
    return result;
}

LobeShape with_width(const LobeShape& shape, double width) {
    LobeShape result = shape;
    if (auto* ggx = std::get_if<GgxShape>(&result)) {
        ggx->alpha = width;
    }
    return result;
}

bool is_glossy(const LobeShape& shape) {
    return std::visit([](const auto& s) { return s.is_glossy(); }, shape);
}

bool is_mirror(const LobeShape& shape) {
    return lobe_width(shape) == 0;
}

namespace {

/// Smallest cosθ_o with a finite reciprocal.
constexpr double kLeastCosine = 1e-300;

}  // namespace

double lobe_value(const LobeShape& shape, const Vec3d& wi, const Vec3d& wo) {
    if (!(wi.z > 0 && wo.z > kLeastCosine)) {
        return 0;
    }
    return std::visit([&](const auto& s) { return s.width() > 0 ? s.value(wi, wo) : 0.0; }, shape);
}

void lobe_values(const LobeShape& shape, const double* x, const double* y, const double* z, std::size_t count,
                 const Vec3d& wo, float* values) {
    std::visit(
        [&](const auto& s) {
            const bool any = wo.z > kLeastCosine && s.width() > 0;
            for (std::size_t i = 0; i < count; ++i) {
                values[i] = any && z[i] > 0 ? static_cast<float>(s.value(Vec3d(x[i], y[i], z[i]), wo)) : 0.0F;
            }
        },
        shape);
}

double lobe_albedo(const LobeShape& shape, double cos_theta_o) {
    return std::visit([&](const auto& s) { return s.albedo(cos_theta_o); }, shape);
}

Vec3d sample_lobe(const LobeShape& shape, const Vec3d& wo, const glm::dvec2& point) {
    return std::visit([&](const auto& s) { return s.sample(wo, point); }, shape);
}

double lobe_density(const LobeShape& shape, const Vec3d& wo, const Vec3d& wi) {
    return wi.z > 0 ? std::visit([&](const auto& s) { return s.density(wo, wi); }, shape) : 0.0;
}

double largest_lobe_density(const LobeShape& shape, const Vec3d& wo) {
    return std::visit([&](const auto& s) { return s.largest_density(wo); }, shape);
}

LobeShape sampled_shape(const LobeShape& shape) {
    return std::visit([](const auto& s) { return LobeShape(s.sampled()); }, shape);
}

}  // namespace shlight
