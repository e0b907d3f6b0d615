// SPDX-License-Identifier: MIT
//
// Moments of a lobe by a product rule, many directions at once.
#pragma once

#include <span>

#include "lobes/lobe_moments.h"
#include "math/legendre.h"

namespace shlight {

/// ∫ f·cos Y_lm dω for m ≥ 0 and l < 64, into moments, and returns ∫ (f·cos)² dω. The rule's numbers of nodes must be
/// multiples of kMomentLanes, and cos_theta_o > 0.
double integrate_moments(const LobeShape& shape, double cos_theta_o, const LobeRule& rule, std::span<double> moments);
inline constexpr std::size_t kMomentLanes = 8;

}  // namespace shlight
