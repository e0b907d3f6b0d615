// SPDX-License-Identifier: MIT
//
// Constants of the recurrences of cap_bands-inl.h, the same for every light.
#pragma once

#include <array>

#include "math/legendre.h"

namespace shlight {

/// Constants of degree m of band l; c_m = √((l-m)(l+m+1)). Entries without a meaning are 0. The turn about a cap's axis
/// gives N_{m-1} = down_a cotθ N_m - down_b N_{m+1} for 1 ≤ m ≤ l, and N_{m+1} = up_a cotθ N_m - up_b N_{m-1} for
/// 1 ≤ m < l.
template <class T>
struct CapStep {
    T down_a, down_b;  ///< 2m / c_{m-1} and c_m / c_{m-1}
    T up_a, up_b;      ///< 2m / c_m and c_{m-1} / c_m
    T down_share;      ///< 2 / c_{m-1}
    T down_plane;      ///< 2 P̄_l^m(0) / c_{m-1}, zero for odd l-m
    T ladder;          ///< c_m
};

/// Constants of band l.
template <class T>
struct CapBand {
    T diagonal;         ///< P̂_l^l
    T sectoral;         ///< P̂_l^l / (l+1)
    T casoratian;       ///< 2 / c_0
    T four_pi_over;     ///< 4π / (2l+1)
    T inverse_laplace;  ///< 1 / (l(l+1))
    T at_pole;          ///< √((2l+1) / 4π), P̄_l^0(1)
    T rise_a, rise_b;   ///< (l-1)/l and (2l-1)/l: P_l - P_{l-1} = rise_a (P_{l-1} - P_{l-2}) - rise_b (1-z) P_{l-1}
};

/// Constants of degree m in any band.
template <class T>
struct CapDegree {
    T weight;  ///< 4 / m
    T moment;  ///< 2 / (m² - 1)
    T next;    ///< m + 1
};

template <class T>
struct CapConstants {
    std::array<CapStep<T>, kCosineMax> steps;
    std::array<CapBand<T>, kMaxOrder> bands;
    std::array<CapDegree<T>, kMaxOrder> degrees;

    static const CapConstants& get();
};

extern template struct CapConstants<float>;
extern template struct CapConstants<double>;

}  // namespace shlight
