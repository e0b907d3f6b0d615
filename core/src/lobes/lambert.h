// SPDX-License-Identifier: MIT
//
// What is known of Lambert's lobe in closed form.
#pragma once

#include <vector>

namespace shlight {

/// Of the clipped cosine only the horizon is beyond bands 0 and 1, and light is clipped there: a fit has no terms
/// beyond this order.
inline constexpr int kLambertOrder = 2;

/// Writes the cosine_count(order) cosine terms of the fit over the upper hemisphere: z/π is one harmonic, and order 1
/// can only be the mean 1/(2π).
void fit_lambert(int order, float* cosine_terms);
/// Its L2 error ÷ the lobe's norm.
double lambert_error(int order);
/// ∫ z/π Y_l0 over the upper hemisphere, l = 0 … 63, as cosine terms.
std::vector<double> lambert_moments();

}  // namespace shlight
