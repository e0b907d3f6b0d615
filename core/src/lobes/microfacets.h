// SPDX-License-Identifier: MIT
//
// Constants of microfacets' lobes that scalar code and lanes share.
#pragma once

namespace shlight {

/// cosθ ÷ (α sinθ) from which on Beckmann's microfacets do not hide each other, in the approximation of Walter et al.
/// 2007.
inline constexpr double kUnmasked = 1.6;
/// tan²θ_h ÷ α² beyond which lanes take this one, where all distributions are as good as 0; its square is a float.
inline constexpr double kLargestSlope2 = 1e6;

}  // namespace shlight
