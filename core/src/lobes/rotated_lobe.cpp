// SPDX-License-Identifier: MIT
#include "lobes/rotated_lobe.h"

#include <cmath>
#include <numbers>

#include "shlight/basis.h"
#include "simd/dot_products.h"

namespace shlight {

const float* RotatedLobe::coefficients(const ShProjection& lobe, float cos_theta_o, int order) {
    lobe.coefficients(cos_theta_o, order, terms_.data());
    if (lobe.is_zonal()) {
        set_zonal(order);
    } else {
        set_turned(order);
    }
    return coefficients_.data();
}

Rgb RotatedLobe::reflected(const ColorHarmonics& light, const float* lobe, int order) {
    Rgb sum;
    for (int c = 0; c < 3; ++c) {
        dot_products(light[static_cast<std::size_t>(c)].data(), lobe,
                     static_cast<std::size_t>(coefficient_count(order)), 1, &sum[c]);
    }
    return sum;
}

void RotatedLobe::set_zonal(int order) {
    // A zonal expansion about an axis is a sum of P_l(ω·axis) = 4π/(2l+1) Σ_m Y_lm(axis) Y_lm(ω) (Eqs. 6 and 7 of the
    // paper).
    sh_basis(Vec3f(frame_[2]), order, coefficients_.data());
    for (int l = 0; l < order; ++l) {
        const float factor = terms_[static_cast<std::size_t>(cosine_index(l, 0))] *
                             std::sqrt(4 * std::numbers::pi_v<float> / static_cast<float>(2 * l + 1));
        for (int m = -l; m <= l; ++m) {
            coefficients_[static_cast<std::size_t>(coefficient_index(l, m))] *= factor;
        }
    }
}

void RotatedLobe::set_turned(int order) {
    for (int l = 0; l < order; ++l) {
        float* center = &coefficients_[static_cast<std::size_t>(coefficient_index(l, 0))];
        const float* band = &terms_[static_cast<std::size_t>(cosine_index(l, 0))];
        center[0] = band[0];
        for (int m = 1; m <= l; ++m) {
            center[m] = band[m];
            center[-m] = 0;
        }
    }
    if (!rotation_) {
        rotation_.emplace(frame_);
    }
    rotation_->apply(order, coefficients_.data());
}

}  // namespace shlight
