// SPDX-License-Identifier: MIT
//
// Coefficients of a region from boundary integrals along its edge, lobe by lobe.
//
//   l (l+1) S_l = (2l-1) B_{l-1} + (l-2) (l-1) S_{l-2},   S_l = ∫ P_l(ω·ω_d) dω        (Zhou & Wei 2020, Eqs. 9, 10)
//   B_l = ∮ P_l(ω·ω_d) ω_d · (ω × dω), the region on the left                         (Eq. 11, with P_l for P_{l-1})
//   S_l(ω_d) = 4π/(2l+1) Σ_m Y_lm(ω_d) L_lm, solved for L_lm by one matrix per band     (Eqs. 6 to 8)
//
// All arithmetic is in T, as the paper does on its GPU. Tables that all lights share are made once.
#pragma once

#include <array>
#include <cstddef>

#include "lobe_directions.h"

namespace shlight::methods {

/// Columns of all tables are lobes in whole groups, padded with the lobes of the next orders or copies of the last.
inline constexpr std::size_t kLobeGroup = 4;

/// Number of columns that an order uses, in whole groups.
constexpr std::size_t lobe_columns(int order) {
    return (static_cast<std::size_t>(lobe_count(order)) + kLobeGroup - 1) / kLobeGroup * kLobeGroup;
}

inline constexpr std::size_t kLobeColumns = lobe_columns(kMaxZonalOrder);

/// One value for each lobe.
template <class T>
using LobeRow = std::array<T, kLobeColumns>;

/// One value for each band (or power) and lobe. Not initialised.
template <class T>
using LobeTable = std::array<LobeRow<T>, kMaxZonalOrder>;

/// ω_d as columns, rounded to T.
template <class T>
struct LobeAxes {
    LobeRow<T> x, y, z;

    static const LobeAxes& get();

    /// v·ω_d for the first `columns` lobes.
    void dot(const Vec3<T>& v, std::size_t columns, LobeRow<T>& products) const {
        for (std::size_t i = 0; i < columns; ++i) {
            products[i] = v.x * x[i] + v.y * y[i] + v.z * z[i];
        }
    }
};

/// Factors of the recurrences, by band.
template <class T>
struct ZonalConstants {
    std::array<T, kMaxZonalOrder> forth{}, back{};   ///< (2l-1) / l and (l-1) / l: P_l = forth z P_{l-1} - back P_{l-2}
    std::array<T, kMaxZonalOrder> share{};           ///< 1 / (l+1)
    std::array<T, kMaxZonalOrder> inner{}, outer{};  ///< S_l = outer B_{l-1} + inner S_{l-2}

    constexpr ZonalConstants() {
        share[0] = 1;
        for (int l = 1; l < kMaxZonalOrder; ++l) {
            const auto i = static_cast<std::size_t>(l);
            forth[i] = static_cast<T>(static_cast<double>(2 * l - 1) / l);
            back[i] = static_cast<T>(static_cast<double>(l - 1) / l);
            share[i] = static_cast<T>(1.0 / (l + 1));
            outer[i] = static_cast<T>(static_cast<double>(2 * l - 1) / (l * (l + 1)));
            inner[i] = static_cast<T>(static_cast<double>((l - 2) * (l - 1)) / (l * (l + 1)));
        }
    }
};

template <class T>
inline constexpr ZonalConstants<T> kZonal;

/// Coefficients of a region, order² values. integrals: in row l + 1 the boundary integrals B_l, l = 0 … order - 2; they
/// are overwritten by S_l in row l. orientation: -1 if the region lay on the right.
/// Precondition: 1 ≤ order ≤ kMaxZonalOrder.
template <class T>
void zonal_coefficients(LobeTable<T>& integrals, T orientation, T solid_angle, int order, T* coefficients);

/// The condition number of band l: the largest singular value of Y_lm(ω_d), 2l + 1 directions, ÷ the smallest.
/// Precondition: 0 ≤ band < kMaxZonalOrder.
double lobe_condition(int band);

extern template struct LobeAxes<float>;
extern template struct LobeAxes<double>;

}  // namespace shlight::methods
