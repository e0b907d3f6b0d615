// SPDX-License-Identifier: MIT
//
// Dot products of rows with rows.
#pragma once

#include <cstddef>

namespace shlight {

/// values[i] = Σ_k a[i · size + k] b[i · size + k] for i < count.
void dot_products(const float* a, const float* b, std::size_t size, std::size_t count, float* values);
void dot_products(const double* a, const double* b, std::size_t size, std::size_t count, double* values);

}  // namespace shlight
