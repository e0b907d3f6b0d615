// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

namespace shlight {

/// Gauss–Legendre rule on (0, 1): exact for polynomials of degree 2·size - 1.
struct GaussRule {
    std::vector<double> nodes;
    std::vector<double> weights;  ///< sum 1
};

/// Number of points of the largest rule.
inline constexpr int kMaxGaussPoints = 64;

/// The rule of 1 … kMaxGaussPoints points, computed once.
const GaussRule& gauss_rule(int points);

}  // namespace shlight
