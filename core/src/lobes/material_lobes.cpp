// SPDX-License-Identifier: MIT
#include "lobes/material_lobes.h"

#include <algorithm>

namespace shlight {

double narrowest(const LobeShape& lobe, double cos_theta_o) {
    // At its peak a lobe is 2α wide across the plane of incidence's normal, and cosθ_o times that along it.
    return is_glossy(lobe) ? std::min(1.0, 2 * lobe_width(lobe) * std::max(cos_theta_o, kLeastFittedCosine)) : 1.0;
}

MaterialLobes::MaterialLobes(std::span<const Lobe> lobes, int order, double tolerance)
    : auto_order_(order == 0), tolerance_(tolerance) {
    for (const Lobe& lobe : lobes) {
        if (lobe.color == Rgb(0)) {
            continue;
        }
        lobes_.push_back(lobe);
        if (!auto_order_) {
            fits_.push_back(is_mirror(lobe.shape) ? nullptr : warped_fit(lobe.shape, order));
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

double MaterialLobes::narrowest(double cos_theta_o) const {
    double least = 1;
    for (const Lobe& lobe : lobes_) {
        least = std::min(least, shlight::narrowest(lobe.shape, cos_theta_o));
    }
    return least;
}

}  // namespace shlight
