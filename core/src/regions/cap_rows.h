// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "regions/cap_arrays.h"
#include "shlight/types.h"

namespace shlight {

/// order² coefficients of the cap inside circle i, or of sphere i, at rows + i · order².
void cap_rows(const CapArrays& circles, std::size_t count, int order, bool clip, float* rows, Output output);
void cap_rows(const CapArrays& circles, std::size_t count, int order, bool clip, double* rows, Output output);
void cap_rows(const SphereArrays& spheres, std::size_t count, int order, bool clip, float* rows, Output output);

}  // namespace shlight
