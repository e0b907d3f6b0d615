// SPDX-License-Identifier: MIT
//
// The linear system that turns boundary values into integrals, band by band (docs/algorithms.md, "One generator").
//
// A turn of the sphere about L = (sinθ, 0, cosθ) relates the cosine terms of one band to its sine terms:
//   -a_{m-1} X_{m-1} + m cosθ X_m - a_m X_{m+1} = R_m,  m = 1 … l,   a_m = ½ sinθ √((l-m)(l+m+1)).
// In orthonormal unknowns its singular values are exactly 1 … l, its null vector is N_m = P̄_l^m(cosθ).
#pragma once

#include <array>
#include <numbers>

#include "math/legendre.h"

namespace shlight {

/// A particular solution for any right side, by the discrete Green's function of the three-term recurrence.
/// All quantities are scaled by powers of sinθ, so nothing overflows or is divided by sinθ, poles included.
template <class T>
class BandSystem {
  public:
    /// n_hat: P̂_l^m(cosθ), m = 0 … l, kept by reference; l ≥ 1.
    BandSystem(int l, T cos_tilt, T sin_tilt, const T* n_hat) : l_(l), sin_tilt_(sin_tilt), n_hat_(n_hat) {
        // The second solution starts where its Casoratian with N is largest: Q_0 = -N_1, Q_1 = N_0.
        const auto& constants = LegendreConstants<T>::get();
        const T* climb = &constants.climb[at(l, 0)];
        const T* fall = &constants.fall[at(l, 0)];
        const T sin2 = sin_tilt * sin_tilt;
        q_hat_[0] = -n_hat[1];
        q_hat_[1] = n_hat[0];
        for (int m = 1; m < l; ++m) {
            q_hat_[m + 1] = climb[m] * cos_tilt * q_hat_[m] - fall[m] * sin2 * q_hat_[m - 1];
        }
        scale_ = 2 / (constants.ladder[at(l, 0)] * (n_hat[0] * n_hat[0] + sin2 * n_hat[1] * n_hat[1]));
    }

    /// x[0 … l] from right[1 … l].
    void solve(const T* right, T* x) const {
        // N decays where Q grows, so Q is summed upwards and N downwards; a prefix difference would lose all digits.
        // Both sums run in one loop because each step of either waits for the one before.
        std::array<T, kMaxOrder> below, above;
        T upwards = 0;
        T downwards = 0;
        above[l_] = 0;
        for (int m = 1, k = l_; m <= l_; ++m, --k) {
            upwards = sin_tilt_ * upwards + q_hat_[m] * right[m];
            below[m] = upwards;
            downwards = sin_tilt_ * (downwards + n_hat_[k] * right[k]);
            above[k - 1] = downwards;
        }
        x[0] = scale_ * q_hat_[0] * above[0];
        for (int m = 1; m <= l_; ++m) {
            x[m] = scale_ * (n_hat_[m] * below[m] + q_hat_[m] * above[m]);
        }
    }

  private:
    int l_;
    T sin_tilt_;
    T scale_;
    const T* n_hat_;
    std::array<T, kMaxOrder> q_hat_;
};

/// N · x with the weights 1, 2, 2, … of unnormalised cosine terms.
template <class T>
T null_component(int l, const T* null, const T* x) {
    T sum = 0;
    for (int m = 1; m <= l; ++m) {
        sum += null[m] * x[m];
    }
    return null[0] * x[0] + 2 * sum;
}

/// The multiple of N that x lacks for the zonal integral ∫ P_l(ω·L) to be right.
template <class T>
T missing_null_component(int l, const T* null, T zonal_integral, const T* x) {
    const T four_pi_over = static_cast<T>(4 * std::numbers::pi_v<T>) / static_cast<T>(2 * l + 1);
    return zonal_integral - four_pi_over * null_component(l, null, x);
}

/// Replaces the part of x along the null vector by the one that the zonal integral ∫ P_l(ω·L) demands.
template <class T>
void set_null_component(int l, const T* null, T zonal_integral, T* x) {
    const T correction = missing_null_component(l, null, zonal_integral, x);
    for (int m = 0; m <= l; ++m) {
        x[m] += correction * null[m];
    }
}

}  // namespace shlight
