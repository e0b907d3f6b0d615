// SPDX-License-Identifier: MIT
//
// Hashes of floats, as operations of shader programs.
#pragma once

#include <cstddef>

#include "shaders/operations.h"

namespace shlight {

/// A number 0 … 1 of the bits of 1 … 4 arguments.
template <std::size_t kCount>
void hash(const OperationLanes& lanes);

}  // namespace shlight
