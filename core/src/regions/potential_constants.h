// SPDX-License-Identifier: MIT
//
// Constants of the potential F = Σ f_lm Y_lm / (l(l+1)) along arcs (docs/theory.md, 4.3).
#pragma once

#include <cstdint>
#include <vector>

#include "regions/arc_rows.h"

namespace shlight {

/// Beyond this order the numbers that q_l are made of by Chebyshev polynomials cancel too much for float.
inline constexpr int kMaxChebyshevOrder = 8;

/// What takes a lobe's terms to two series for each degree m, whose sums make the normal derivative of the potential,
///   ν·∇F = Re Σ_m [ ν_z D_m + (ν_x + iν_y) S_m ] (x+iy)^{m-1},   D_m = Σ_l down f_l^{m-1} q_l,  S_m = Σ_l same f_l^m
///   q_l.
/// The polynomials q_l of z are P̂_l^m but for factors that make their recurrence q_{l+1} = rise z q_l - q_{l-1}.
/// In the order of summation (Clenshaw): m = order-1 … 1, for each l = order-1 … m.
struct PotentialConstants {
    std::vector<double> rise;  ///< of q_{l+1}
    /// What the Chebyshev polynomials U_k have of q_l, k = l - m: for each m a square, row by row of U_k, k falling,
    /// columns as the terms. Only for orders up to kMaxChebyshevOrder.
    std::vector<double> chebyshev;
    std::vector<double> down, same;
    std::vector<std::uint16_t> term;  ///< cosine_index(l, m); that of (l, m-1) is one less

    static const PotentialConstants& of(int order);
};

/// kGaussErrorGrowth for a lobe's potential along great circles. Its band l has waves of at most l - 1 cycles a turn,
/// no higher than |f_l| √((2l+1) / (8π l(l+1))), so with κ the radians that waves of order - 2 cycles have the error is
///   E_k Σ_l |f_l| √((2l+1) / (8π l(l+1))) ((l-1) / (order-2))^{2k},
/// here in units of the largest term. terms: cosine_count(order) of them.
GaussErrorGrowth lobe_error_growth(const float* terms, int order);

}  // namespace shlight
