# SPDX-License-Identifier: MIT
#
# The instruction sets that kernels are compiled for: SHLIGHT_KERNEL_TARGETS, by Highway's names and best first, and
# SHLIGHT_KERNEL_DEFINITIONS, which tell Highway. Each takes its own time to compile. SHLIGHT_KERNEL_OPTIONS: the
# compiler's options for all sources of the core.
include(CheckCXXSourceRuns)

option(SHLIGHT_ALL_TARGETS "Compile kernels for AVX-512, AVX2 and SSE4; OFF: for SSE4 and the best of this machine" ON)

if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
  # SSE4 is the least that Blender runs on too. The sets between these differ too little to be worth their code.
  set(SHLIGHT_KERNEL_TARGETS AVX3 AVX2 SSE4)
  if(NOT SHLIGHT_ALL_TARGETS AND NOT CMAKE_CROSSCOMPILING)
    set(SHLIGHT_KERNEL_TARGETS SSE4)
    set(CMAKE_REQUIRED_LIBRARIES hwy::hwy)
    foreach(target AVX2 AVX3)
      check_cxx_source_runs(
        "#include <hwy/targets.h>\nint main() { return (hwy::SupportedTargets() & HWY_${target}) != 0 ? 0 : 1; }"
        SHLIGHT_MACHINE_HAS_${target})
      if(SHLIGHT_MACHINE_HAS_${target})
        set(SHLIGHT_KERNEL_TARGETS ${target} SSE4)
      endif()
    endforeach()
    unset(CMAKE_REQUIRED_LIBRARIES)
  endif()
  list(TRANSFORM SHLIGHT_KERNEL_TARGETS PREPEND HWY_ OUTPUT_VARIABLE bits)
  list(JOIN bits "|" bits)
  set(SHLIGHT_KERNEL_DEFINITIONS HWY_BASELINE_TARGETS=HWY_SSE4 "HWY_DISABLED_TARGETS=(~(${bits}))")
else()
  # On ARM NEON; elsewhere plain C++ in place of vectors, which Highway distrusts with GCC before 12.3 for a fault in
  # products of short integers: there are none here.
  set(SHLIGHT_KERNEL_TARGETS)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64)$")
    # Highway's NEON has instructions for AES. GCC inlines none of its vectors into the members of std::array without them.
    set(SHLIGHT_KERNEL_OPTIONS -march=armv8-a+crypto)
  endif()
  set(SHLIGHT_KERNEL_DEFINITIONS HWY_BROKEN_EMU128=0
    "HWY_DISABLED_TARGETS=(HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128)")
endif()
