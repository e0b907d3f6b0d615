// SPDX-License-Identifier: MIT
//
// Eq. 2 of the paper, the basis of real harmonics, in many directions at once.
#pragma once

#include <cstddef>

#include "shlight/types.h"

namespace shlight {

/// rows: order² values for each direction. Directions may have any length > 0; they are divided by their largest
/// component first, which keeps squares in range.
/// Returns whether all directions were finite and not zero; if not, some rows may not have been written.
bool basis_rows(const Vec3<float>* directions, std::size_t count, int order, float* rows,
                Output output = Output::cached);
bool basis_rows(const Vec3<double>* directions, std::size_t count, int order, double* rows,
                Output output = Output::cached);

}  // namespace shlight
