// SPDX-License-Identifier: MIT
//
// What files on microfacets' lobes share.
#pragma once

namespace shlight {

/// cosθ ÷ (α sinθ) from which on Beckmann's microfacets do not hide each other, in the approximation of Walter et al.
/// 2007.
inline constexpr double kUnmasked = 1.6;
/// cosθ Λ of Beckmann's microfacets in that approximation; as a quotient it is finite for grazing angles.
/// across: α sinθ.
inline double beckmann_hidden(double across, double cosine) {
    if (cosine >= kUnmasked * across) {
        return 0;
    }
    const double a = cosine / across;
    return across * ((0.396 * a - 1.259) * a + 1) / (2.181 * a + 3.535);
}
/// tan²θ_h ÷ α² beyond which lanes take this one, where all distributions are as good as 0; its square is a float.
inline constexpr double kLargestSlope2 = 1e6;

}  // namespace shlight
