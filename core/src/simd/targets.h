// SPDX-License-Identifier: MIT
//
// The instruction set of the batch kernels. Each kernel is compiled for several sets, and the best one that the machine
// has is chosen when the first kernel runs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace shlight {

/// Names of the compiled instruction sets that this machine has, best first. The names are Highway's, such as "AVX3"
/// (AVX-512), "AVX2", "SSE4" or "NEON". Results differ by rounding only.
std::vector<std::string> kernel_targets();

/// Name of the instruction set in use: the best one, unless another was forced.
std::string kernel_target();

/// Uses one of kernel_targets() from now on, in all threads; for tests and measurements, while no kernel runs.
/// Throws std::invalid_argument naming `target` if it is none of kernel_targets().
void force_kernel_target(const std::string& target);

/// Uses the set that the environment variable SHLIGHT_KERNEL_TARGET names, or the best one. Throws
/// std::invalid_argument naming the variable if its value is none of kernel_targets(), std::runtime_error if that list
/// is empty.
void choose_kernel_target();

/// Forces a target during its lifetime.
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
