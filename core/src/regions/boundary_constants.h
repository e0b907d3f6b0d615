// SPDX-License-Identifier: MIT
//
// Constants of the two integrals along boundaries: of coefficients, and of a lobe's potential
// F = Σ f_lm Y_lm / (l(l+1)) (docs/theory.md, 4.2 and 4.3).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "math/legendre.h"
#include "regions/arcs.h"

namespace shlight {

/// The monic multiples of P̂_l^m, P̃_{l+1} = z P̃_l - β P̃_{l-1}, and what takes P̃_l^m (x+iy)^{m-1} to coefficients.
///
/// ν is tangent to the sphere, so ν·∇ may be taken of any extension beyond it, such as P̂_l^m(z) (x+iy)^m:
///   ν·∇ Y_l^m = ν_z √((l-m)(l+m+1)) P̂_l^{m+1} (x+iy)^m + m (ν_x + iν_y) P̂_l^m (x+iy)^{m-1}.
/// With its first term shifted by one degree all that is needed of degree m ≥ 1 is P̂_l^m (x+iy)^{m-1}.
template <class T>
struct MomentStep {
    T beta;     ///< β_l
    T down;     ///< factor of ν_z … in coefficient m-1, with √2, Stokes' 1/(l(l+1)) and P̂/P̃; 0 for band 1
    T same;     ///< factor of (ν_x + iν_y) … in coefficient m
    T horizon;  ///< factor of ν_z … at z = 0: down P̃_l^m(0)
};

/// For m = 1, 2, … and l = m … kMaxOrder-1.
template <class T>
class MomentSteps {
  public:
    static const MomentSteps& get();
    /// l = m, m+1, …
    const MomentStep<T>* of_degree(int m) const {
        return &steps_[static_cast<std::size_t>((m - 1) * (2 * kMaxOrder - m) / 2)];
    }

  private:
    MomentSteps();

    std::array<MomentStep<T>, kCosineMax> steps_{};
};

extern template class MomentSteps<float>;
extern template class MomentSteps<double>;

/// Factors from a lobe's terms to two series for each degree m, whose sums make the normal derivative of the potential,
///   ν·∇F = Re Σ_m [ ν_z D_m + (ν_x + iν_y) S_m ] (x+iy)^{m-1},   D_m = Σ_l down f_l^{m-1} q_l,  S_m = Σ_l same f_l^m
///   q_l.
/// The polynomials q_l of z are P̂_l^m but for factors that make their recurrence q_{l+1} = rise z q_l - q_{l-1}.
/// In the order of summation (Clenshaw): m = order-1 … 1, for each l = order-1 … m.
struct PotentialConstants {
    std::vector<double> rise;  ///< factors of z q_l in q_{l+1}
    std::vector<double> down, same;
    std::vector<std::uint16_t> term;  ///< cosine_index(l, m); that of (l, m-1) is one less

    static const PotentialConstants& of(int order);
};

}  // namespace shlight
