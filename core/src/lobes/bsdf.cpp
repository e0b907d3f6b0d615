// SPDX-License-Identifier: MIT
#include "shlight/bsdf.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>

#include "base/checks.h"
#include "lobes/view_grid.h"
#include "shlight/lobe_table.h"

namespace shlight {
namespace {

void check_color(const char* name, const Rgb& color) {
    for (int i = 0; i < 3; ++i) {
        if (!(color[i] >= 0 && color[i] <= kLargestColor)) {
            reject(std::string(name) + " must lie in [0, 1e10]");
        }
    }
}

float largest(const Rgb& c) {
    return std::max({c.x, c.y, c.z});
}

bool is_black(const Rgb& c) {
    return c == Rgb(0);
}

void check_ior(double ior) {
    if (ior != 0 && !(std::isfinite(ior) && ior > 1)) {
        reject("ior must be finite and greater than 1");
    }
}

/// For an ior near 1 the dielectric Fresnel curve becomes a step at grazing angles, and for a large ior it is flat.
/// Beyond these limits it differs by more than 1e-2 from its replacement only where cosθ_d < 3e-3.
constexpr double kLeastIor = 1 + 1e-6, kLargestIor = 100;

/// The lobe with the Fresnel factor's rise from 0 at normal incidence to 1. ior: 0 for Schlick's curve.
GgxShape edge_shape(double alpha, double ior) {
    return ior == 0 ? GgxShape{alpha, Fresnel::schlick}
                    : GgxShape{alpha, Fresnel::dielectric, std::max(ior, kLeastIor)};
}

}  // namespace

double Lobe::albedo(double cos_theta_o) const {
    return fit ? fit->albedo(cos_theta_o) : lobe_albedo(shape, cos_theta_o);
}

ViewWeight::ViewWeight(std::vector<float> nodes) : nodes_(std::move(nodes)) {
    check_size("weight", nodes_.size(), kViewNodes);
    if (!std::all_of(nodes_.begin(), nodes_.end(), [](float node) { return node >= 0 && node <= 1; })) {
        reject("weight must lie in [0, 1]");
    }
}

float ViewWeight::operator()(float cos_theta_o) const {
    return interpolate_even(nodes_, cos_theta_o);
}

Bsdf Bsdf::lobe(const LobeShape& shape, const Rgb& color, std::shared_ptr<const ViewWeight> weight, int order) {
    check_color("color", color);
    Bsdf b;
    b.lobes_.push_back({shape, is_mirror(shape) || shlight::is_anisotropic(shape) ? nullptr : boosted_fit(shape, order),
                        color, std::move(weight), 0, order});
    return b;
}

Bsdf Bsdf::lambert(const Rgb& albedo) {
    check_color("albedo", albedo);
    return lobe(LambertShape{}, albedo);
}

Bsdf Bsdf::ggx(float roughness, const Rgb& f0, double ior) {
    if (!(roughness >= 0 && roughness <= 1)) {
        reject("roughness must lie in [0, 1]");
    }
    check_color("f0", f0);
    check_ior(ior);
    const double alpha = roughness < kLeastRoughness ? 0 : static_cast<double>(roughness) * roughness;
    Bsdf b;
    if (!is_black(f0)) {
        b = lobe(GgxShape{alpha, Fresnel::one}, f0);
    }
    const Rgb rest = Rgb(1) - glm::min(f0, Rgb(1));
    if (!is_black(rest) && ior <= kLargestIor) {
        b = b + lobe(edge_shape(alpha, ior), rest);
    }
    return b;
}

Bsdf Bsdf::varying(const GgxShape& shape) {
    Bsdf b;
    b.lobes_.push_back({shape, nullptr, Rgb(1), nullptr, 1});
    return b;
}

Bsdf Bsdf::varying_ggx(double ior) {
    check_ior(ior);
    const Bsdf head_on = varying({1, Fresnel::one});
    return ior <= kLargestIor ? head_on + varying(edge_shape(1, ior)) : head_on;
}

Bsdf Bsdf::table(const std::shared_ptr<const LobeTable>& table, int order) {
    if (table->channels() == 1) {
        return lobe(TableShape{table}, Rgb(1), nullptr, order);
    }
    Bsdf sum;
    for (int channel = 0; channel < 3; ++channel) {
        Rgb color(0);
        color[channel] = 1;
        sum = sum + lobe(TableShape{table, channel}, color, nullptr, order);
    }
    return sum;
}

Bsdf Bsdf::layer(const Bsdf& top, const Bsdf& base) {
    std::vector<float> passed(kViewNodes);
    for (int i = 0; i < kViewNodes; ++i) {
        const float reflected = largest(top.albedo(std::cos(view_angle(i))));
        passed[i] = std::clamp(1 - reflected, 0.0F, 1.0F);
    }
    Bsdf result = top;
    for (Lobe lobe : base.lobes_) {
        std::vector<float> weight = passed;
        if (lobe.weight) {
            std::transform(weight.begin(), weight.end(), lobe.weight->nodes().begin(), weight.begin(),
                           std::multiplies<>());
        }
        lobe.weight = std::make_shared<const ViewWeight>(std::move(weight));
        result.lobes_.push_back(std::move(lobe));
    }
    return result;
}

Bsdf Bsdf::operator+(const Bsdf& other) const {
    Bsdf sum = *this;
    sum.lobes_.insert(sum.lobes_.end(), other.lobes_.begin(), other.lobes_.end());
    return sum;
}

Bsdf Bsdf::scaled(const Rgb& factor) const {
    check_color("factor", factor);
    Bsdf result = *this;
    for (Lobe& lobe : result.lobes_) {
        lobe.color *= factor;
        check_color("factor times the material's own colour", lobe.color);
    }
    return result;
}

Bsdf Bsdf::uncolored() const {
    Bsdf result = *this;
    std::erase_if(result.lobes_, [](const Lobe& lobe) { return is_black(lobe.color); });
    for (Lobe& lobe : result.lobes_) {
        lobe.color = Rgb(1);
    }
    return result;
}

bool Bsdf::is_anisotropic() const {
    return std::any_of(lobes_.begin(), lobes_.end(),
                       [](const Lobe& lobe) { return shlight::is_anisotropic(lobe.shape); });
}

Rgb Bsdf::evaluate(const Vec3d& wi, const Vec3d& wo) const {
    Rgb sum(0);
    for (const Lobe& lobe : lobes_) {
        sum += lobe.scale(static_cast<float>(wo.z)) * static_cast<float>(lobe_value(lobe.shape, wi, wo));
    }
    return sum;
}

Rgb Bsdf::albedo(double cos_theta_o) const {
    Rgb sum(0);
    for (const Lobe& lobe : lobes_) {
        sum += lobe.scale(static_cast<float>(cos_theta_o)) * static_cast<float>(lobe.albedo(cos_theta_o));
    }
    return sum;
}

}  // namespace shlight
