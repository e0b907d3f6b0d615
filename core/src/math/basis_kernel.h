// SPDX-License-Identifier: MIT
//
// The basis in many directions at once.
#pragma once

#include <cstddef>

#include "shlight/types.h"

namespace shlight {

/// rows[i]: where the order² values of direction i go. Directions of any length > 0; they are scaled by their largest
/// component first, which keeps the squares of tiny and huge ones in range.
/// Returns whether all directions were finite and not zero; if not, some rows may not have been written.
bool basis_rows(const Vec3<float>* directions, std::size_t count, int order, float* rows,
                Output output = Output::cached);
bool basis_rows(const Vec3<double>* directions, std::size_t count, int order, double* rows,
                Output output = Output::cached);

}  // namespace shlight
