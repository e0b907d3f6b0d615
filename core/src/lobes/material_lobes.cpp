// SPDX-License-Identifier: MIT
#include "lobes/material_lobes.h"

#include <algorithm>
#include <cmath>

namespace shlight {

double narrowest(const LobeShape& lobe, double cos_theta_o) {
    // At its peak a lobe is 2α wide across the plane of incidence, and cosθ_o times that along it.
    return is_glossy(lobe) ? std::min(1.0, 2 * lobe_width(lobe) * std::max(cos_theta_o, kLeastFittedCosine)) : 1.0;
}

double distance_of_change(const LobeShape& lobe, const Vec3d& wi, const Vec3d& wo) {
    const Vec3d half = wi + wo;
    return std::min(1.0, std::hypot(half.x, half.y, lobe_width(lobe) * half.z));
}

bool spread_alike(const Lobe& a, const Lobe& b) {
    return a.varying_width == b.varying_width && sampled_shape(a.shape) == sampled_shape(b.shape);
}

MaterialLobes::MaterialLobes(std::span<const Lobe> lobes, int order, double tolerance, std::uint32_t light_set)
    : auto_order_(order == 0), tolerance_(tolerance), light_set_(light_set) {
    for (const Lobe& lobe : lobes) {
        if (lobe.color == Rgb(0)) {
            continue;
        }
        lobes_.push_back(lobe);
        const auto* ggx = std::get_if<GgxShape>(&lobe.shape);
        const bool unfitted = has_two_widths(lobe.shape);
        grids_.push_back(lobe.varying_width != 0 && ggx != nullptr && !unfitted ? fit_grid(*ggx, order) : nullptr);
        anisotropic_.push_back(
            shlight::is_anisotropic(lobe.shape) && !unfitted
                ? anisotropic_fit(std::get<TableShape>(lobe.shape), auto_order_ ? lobe.only_order : order)
                : nullptr);
        if (!auto_order_) {
            fits_.push_back(is_mirror(lobe.shape) || lobe.varies() ? nullptr : boosted_fit(lobe.shape, order));
        }
    }
}

LobeWeights MaterialLobes::weights(std::span<const double> cos_theta_o, std::vector<Rgb>& values) const {
    const bool vary =
        std::any_of(lobes_.begin(), lobes_.end(), [](const Lobe& lobe) { return lobe.weight != nullptr; });
    values.clear();
    for (const double cosine : vary ? cos_theta_o : cos_theta_o.first(1)) {
        for (const Lobe& lobe : lobes_) {
            values.push_back(lobe.scale(static_cast<float>(cosine)));
        }
    }
    return {values, vary ? lobes_.size() : 0};
}

double MaterialLobes::albedo(std::size_t lobe, const LobeForm& form, double cos_theta_o) const {
    if (!lobes_[lobe].varies()) {
        return lobes_[lobe].albedo(cos_theta_o);
    }
    const bool is_fitted = grids_[lobe] != nullptr && form.width > 0;
    return is_fitted ? grids_[lobe]->albedo(double{form.width}, cos_theta_o)
                     : lobe_albedo(shape(lobe, form), cos_theta_o);
}

double MaterialLobes::narrowest(double cos_theta_o, std::span<const LobeForm> forms) const {
    double least = 1;
    for (std::size_t i = 0; i < lobes_.size(); ++i) {
        const LobeShape own = shape(i, forms[i]);
        least = is_mirror(own) ? least : std::min(least, shlight::narrowest(own, cos_theta_o));
    }
    return least;
}

}  // namespace shlight
