// SPDX-License-Identifier: MIT
//
// Constants of the coefficients of arcs (docs/theory.md, 4.2).
#pragma once

#include <array>
#include <cstddef>

#include "math/legendre.h"

namespace shlight {

/// The monic multiples of P̂_l^m, P̃_{l+1} = z P̃_l - β P̃_{l-1}, and what takes P̃_l^m (x+iy)^{m-1} to coefficients.
///
/// ν is tangent to the sphere, so ν·∇ may be taken of any extension beyond it, such as P̂_l^m(z) (x+iy)^m:
///   ν·∇ Y_l^m = ν_z √((l-m)(l+m+1)) P̂_l^{m+1} (x+iy)^m + m (ν_x + iν_y) P̂_l^m (x+iy)^{m-1}.
/// With its first term shifted by one degree all that is needed of degree m ≥ 1 is P̂_l^m (x+iy)^{m-1}.
template <class T>
struct MomentStep {
    T beta;     ///< from l-1 and l to l+1
    T down;     ///< of ν_z … in coefficient m-1, with √2, Stokes' 1/(l(l+1)) and P̂/P̃; 0 for band 1
    T same;     ///< of (ν_x + iν_y) … in coefficient m
    T horizon;  ///< of ν_z … where z = 0: down P̃_l^m(0)
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

}  // namespace shlight
