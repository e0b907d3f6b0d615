// SPDX-License-Identifier: MIT
#include "material_lobes.h"

#include <algorithm>
#include <limits>

namespace shlight {

MaterialLobes::MaterialLobes(const Bsdf& bsdf, int order, double tolerance)
    : auto_order_(order == 0), tolerance_(tolerance) {
    for (const Lobe& lobe : bsdf.lobes()) {
        if (lobe.color == Rgb(0)) {
            continue;
        }
        lobes_.push_back(lobe);
        if (!auto_order_) {
            fits_.push_back(is_mirror(lobe.shape) ? nullptr : warped_fit(lobe.shape, order));
        }
    }
}

std::optional<LobeAtView> MaterialLobes::at(std::size_t lobe, double cos_theta_o) const {
    const auto light_of = [&](const Lobe& l) {
        return Vec3d(l.scale(static_cast<float>(cos_theta_o))) * l.albedo(cos_theta_o);
    };
    Vec3d all(0);
    for (const Lobe& l : lobes_) {
        all += light_of(l);
    }
    const Vec3d own = light_of(lobes_[lobe]);
    double allowance = std::numeric_limits<double>::infinity();
    for (int channel = 0; channel < 3; ++channel) {
        if (own[channel] > 0) {
            allowance = std::min(allowance, all[channel] / own[channel]);
        }
    }
    if (!(allowance < std::numeric_limits<double>::infinity())) {
        return std::nullopt;
    }
    const WarpedFit* fit = auto_order_ ? lobes_[lobe].fit.get() : fits_[lobe].get();
    return LobeAtView(lobes_[lobe].shape, fit, cos_theta_o, tolerance_ * allowance, auto_order_);
}

double MaterialLobes::narrowest(double cos_theta_o) const {
    double least = 1;
    for (const Lobe& lobe : lobes_) {
        if (const auto* ggx = std::get_if<GgxShape>(&lobe.shape)) {
            // At its peak a lobe is 2α wide across the plane of incidence's normal, and cosθ_o times that along it.
            least = std::min(least, 2 * ggx->alpha * std::max(cos_theta_o, kLeastFittedCosine));
        }
    }
    return least;
}

}  // namespace shlight
