// SPDX-License-Identifier: MIT
#include "material_orders.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace shlight {

OrderedLobe::OrderedLobe(const Lobe& lobe, int order) : lobe_(lobe) {
    if (order != 0) {
        tables_.push_back(fitted(lobe.shape)->table(order));
        return;
    }
    for (const int rung : kOrderLadder) {
        tables_.push_back(fitted(lobe.shape)->table(rung));
    }
}

void OrderedLobe::coefficients(int order, float cos_theta_o, float* cosine_terms) const {
    const auto table =
        std::find_if(tables_.begin(), tables_.end(), [order](const auto& t) { return t->order() == order; });
    (*table)->coefficients(cos_theta_o, cosine_terms);
}

OrderedMaterial::OrderedMaterial(const Bsdf& bsdf, const RenderSettings& settings)
    : order_(settings.order), tolerance_(settings.tolerance) {
    for (const Lobe& lobe : bsdf.lobes()) {
        if (lobe.color != Rgb(0)) {
            lobes_.emplace_back(lobe, settings.order);
        }
    }
}

bool OrderedMaterial::choose_orders(float cos_theta_o, std::span<std::uint8_t> orders) const {
    const auto lobe_norm = [&](const OrderedLobe& lobe) {
        return Vec3d(lobe.lobe().scale(cos_theta_o)) * fitted(lobe.lobe().shape)->norm(cos_theta_o);
    };
    Vec3d squares(0);
    for (const OrderedLobe& lobe : lobes_) {
        const Vec3d norm = lobe_norm(lobe);
        squares += norm * norm;
    }
    bool all_met = true;
    for (std::size_t i = 0; i < lobes_.size(); ++i) {
        const Vec3d norm = lobe_norm(lobes_[i]);
        double allowance = std::numeric_limits<double>::infinity();
        for (int channel = 0; channel < 3; ++channel) {
            if (norm[channel] > 0) {
                allowance = std::min(allowance, std::sqrt(squares[channel]) / norm[channel]);
            }
        }
        if (std::isinf(allowance)) {
            orders[i] = 0;
            continue;
        }
        const OrderChoice choice = fitted(lobes_[i].lobe().shape)->order_for(cos_theta_o, tolerance_ * allowance);
        orders[i] = static_cast<std::uint8_t>(order_ != 0 ? order_ : choice.order);
        all_met = all_met && choice.met;
    }
    return all_met;
}

}  // namespace shlight
