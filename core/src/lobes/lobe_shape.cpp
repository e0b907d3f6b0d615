// SPDX-License-Identifier: MIT
#include "shlight/lobe_shape.h"

#include <algorithm>

#include "shlight/lobe_table.h"

namespace shlight {

double lobe_width(const LobeShape& shape) {
    return std::visit([](const auto& s) { return s.width(); }, shape);
}

bool is_anisotropic(const LobeShape& shape) {
    const auto* own = std::get_if<TableShape>(&shape);
    return own != nullptr ? !own->table->is_isotropic() : has_two_widths(shape);
}

bool is_stretched(const LobeShape& shape) {
    const auto* own = std::get_if<GgxShape>(&shape);
    return own != nullptr && own->across != 0;
}

bool has_two_widths(const LobeShape& shape) {
    return is_stretched(shape) || std::holds_alternative<ToonShape>(shape);
}

bool is_bumped(const LobeShape& shape) {
    const auto* own = std::get_if<DiffuseShape>(&shape);
    return own != nullptr && (own->kind == Diffuse::bumped_ggx || own->kind == Diffuse::bumped_cubic);
}

double lobe_parameter(const LobeShape& shape) {
    const auto* table = std::get_if<TableShape>(&shape);
    return table != nullptr && is_anisotropic(shape) ? table->azimuth : lobe_width(shape);
}

LobeForm lobe_form(const LobeShape& shape) {
    const auto width = static_cast<float>(lobe_width(shape));
    if (const auto* table = std::get_if<TableShape>(&shape)) {
        return {width, 0, static_cast<float>(table->azimuth)};
    }
    if (const auto* toon = std::get_if<ToonShape>(&shape)) {
        return {static_cast<float>(toon->size), static_cast<float>(toon->smooth)};
    }
    const auto* ggx = std::get_if<GgxShape>(&shape);
    return ggx != nullptr ? LobeForm{width, static_cast<float>(ggx->across), static_cast<float>(ggx->azimuth)}
                          : LobeForm{width};
}

LobeShape with_form(const LobeShape& shape, const LobeForm& form) {
    LobeShape result = shape;
    if (auto* ggx = std::get_if<GgxShape>(&result)) {
        ggx->alpha = form.width;
        // Lobes that a hit does not have keep the form of a new LobeForm.
        ggx->across = ggx->across != 0 ? std::max(form.across, form.width) : 0.0F;
    } else if (auto* toon = std::get_if<ToonShape>(&result)) {
        *toon = {toon->glossy, form.width, form.across};
    }
    return with_azimuth(result, form.azimuth);
}

LobeShape with_azimuth(const LobeShape& shape, double azimuth) {
    LobeShape result = shape;
    if (auto* ggx = std::get_if<GgxShape>(&result)) {
        ggx->azimuth = ggx->across != 0 ? azimuth : 0.0;
    } else if (auto* table = std::get_if<TableShape>(&result)) {
        table->azimuth = azimuth;
    }
    return result;
}

LobeShape with_width(const LobeShape& shape, double width) {
    LobeShape result = shape;
    if (auto* ggx = std::get_if<GgxShape>(&result)) {
        ggx->alpha = width;
    }
    return result;
}

LobeForm widened(const LobeShape& shape, const LobeForm& form, double least_width) {
    const auto least = std::holds_alternative<GgxShape>(shape) ? static_cast<float>(least_width) : 0.0F;
    return {std::max(form.width, least), form.across > 0 ? std::max(form.across, least) : form.across, form.azimuth};
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

SampledShape drawn_from(const LobeShape& shape) {
    return std::visit([](const auto& s) { return SampledShape(s.sampled()); }, shape);
}

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
    return std::visit([&](const auto& s) { return s.sample(wo, point); }, drawn_from(shape));
}

double lobe_density(const LobeShape& shape, const Vec3d& wo, const Vec3d& wi) {
    return wi.z > 0 ? std::visit([&](const auto& s) { return s.density(wo, wi); }, drawn_from(shape)) : 0.0;
}

double largest_lobe_density(const LobeShape& shape, const Vec3d& wo) {
    return std::visit([&](const auto& s) { return s.largest_density(wo); }, drawn_from(shape));
}

LobeShape sampled_shape(const LobeShape& shape) {
    return std::visit([](const auto& s) { return LobeShape(s); }, drawn_from(shape));
}

}  // namespace shlight
