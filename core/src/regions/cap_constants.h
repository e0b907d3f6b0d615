// SPDX-License-Identifier: MIT
//
// Constants of the recurrences of cap_bands-inl.h, the same for every light.
#pragma once

#include <array>

#include "math/legendre.h"

namespace shlight {

/// What is needed at degree m of band l; c_m = √((l-m)(l+m+1)). Entries without a meaning are 0.
template <class T>
struct CapStep {
    T down_climb, down_fall;  ///< 2m / c_{m-1}, c_m / c_{m-1}: from m to m-1, 1 ≤ m ≤ l
    T up_climb, up_fall;      ///< 2m / c_m, c_{m-1} / c_m: from m to m+1, 1 ≤ m < l
    T down_share;             ///< 2 / c_{m-1}
    T down_plane;             ///< 2 P̄_l^m(0) / c_{m-1}, zero for odd l-m
    T ladder;                 ///< c_m
};

/// What is needed once in a band.
template <class T>
struct CapBand {
    T diagonal;           ///< P̂_l^l
    T sectoral;           ///< P̂_l^l / (l+1)
    T casoratian;         ///< 2 / c_0
    T four_pi_over;       ///< 4π / (2l+1)
    T inverse_laplace;    ///< 1 / (l(l+1))
    T at_pole;            ///< √((2l+1) / 4π), P̄_l^0(1)
    T keep_rise, lessen;  ///< (l-1)/l and (2l-1)/l, of P_l - P_{l-1} near 1
};

/// What is needed at degree m whatever the band.
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
