// SPDX-License-Identifier: MIT
//
// Which instruction set the batch kernels use. Each kernel is compiled for several, and the best that the machine has
// is chosen when the first one runs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace shlight {

/// Names of the instruction sets that were compiled and that this machine has, best first: Highway's names, such as
/// "AVX3" (AVX-512), "AVX2", "SSE4" or "NEON". All give the same results within rounding.
std::vector<std::string> kernel_targets();

/// The one in use: the best, unless another was forced.
std::string kernel_target();

/// Uses one of kernel_targets() from now on, in all threads; for tests and measurements, while no kernel runs.
/// Throws std::invalid_argument naming `target` if this is none of them.
void force_kernel_target(const std::string& target);

/// Uses the one that the environment variable SHLIGHT_KERNEL_TARGET names, or else the best. Throws
/// std::invalid_argument naming the variable if that is none of them, std::runtime_error if this machine has none.
void choose_kernel_target();

/// Forces a target as long as it lives.
class ForcedKernelTarget {
  public:
    explicit ForcedKernelTarget(const std::string& target);
    ~ForcedKernelTarget();
    ForcedKernelTarget(const ForcedKernelTarget&) = delete;
    ForcedKernelTarget& operator=(const ForcedKernelTarget&) = delete;

  private:
    std::int64_t before_;
};

}  // namespace shlight
