// SPDX-License-Identifier: MIT
//
// Constants of the potential F = Σ f_lm Y_lm / (l(l+1)) along arcs (docs/algorithms.md, "Polygons").
#pragma once

#include <cstdint>
#include <vector>

namespace shlight {

/// What takes a lobe's terms to two series for each degree m, whose sums make the normal derivative of the potential,
///   ν·∇F = Re Σ_m [ ν_z D_m + (ν_x + iν_y) S_m ] (x+iy)^{m-1},   D_m = Σ_l down f_l^{m-1} q_l,  S_m = Σ_l same f_l^m
///   q_l.
/// The polynomials q_l of z are P̂_l^m but for factors that make their recurrence q_{l+1} = rise z q_l - q_{l-1}.
/// In the order of summation (Clenshaw): m = order-1 … 1, for each l = order-1 … m.
struct PotentialConstants {
    std::vector<double> rise;  ///< of q_{l+1}
    std::vector<double> down, same;
    std::vector<std::uint16_t> term;  ///< cosine_index(l, m); that of (l, m-1) is one less

    static const PotentialConstants& of(int order);
};

}  // namespace shlight
