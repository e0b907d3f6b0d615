// SPDX-License-Identifier: MIT
//
// Closed forms of Lambert's lobe.
#pragma once

#include <vector>

namespace shlight {

/// The highest order of a fit over the upper hemisphere, where the cosine is a harmonic of band 1. Higher bands of the
/// clipped cosine only describe its kink at the horizon, at which lights are clipped.
inline constexpr int kLambertOrder = 2;

/// Writes the cosine_count(order) cosine terms of the fit over the upper hemisphere: z/π is one harmonic of band 1, and
/// the fit of order 1 is its mean 1/(2π).
void fit_lambert(int order, float* cosine_terms);
/// L2 error of that fit ÷ L2 norm of the lobe.
double lambert_error(int order);
/// ∫ z/π Y_l0 over the upper hemisphere, l = 0 … 63, as cosine terms.
std::vector<double> lambert_moments();

}  // namespace shlight
