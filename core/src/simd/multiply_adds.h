// SPDX-License-Identifier: MIT
//
// What the machine can do at best, as a measure for the kernels.
#pragma once

#include <cstddef>

namespace shlight {

/// Runs `rounds` rounds of multiply-adds of floats that wait for nothing but themselves, and returns how many of them
/// there were in all lanes: over the time that took, with 2 operations each, the peak of one core.
std::size_t multiply_adds(std::size_t rounds);

}  // namespace shlight
