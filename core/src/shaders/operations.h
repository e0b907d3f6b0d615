// SPDX-License-Identifier: MIT
//
// The loops that evaluate operations of shader programs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "shlight/shader_program.h"

namespace shlight {

/// Arguments and results of one step over some lanes. A row of them may be read and written up to the next multiple of
/// 16 lanes.
struct OperationLanes {
    const float* const* arguments;
    float* const* results;
    std::size_t count;
    const ShaderTable* table;
    const ImageTexture* image;
    std::uint32_t mode;
    const ShaderScript* script;
};

/// Loops in the order of shader_operations().
using OperationLoop = void (*)(const OperationLanes& lanes);
std::span<const OperationLoop> operation_loops();

/// The first operations take differences, and have no loop: between place i + 1 of ShaderReader and the hit.
inline constexpr std::uint32_t kDifferences = 4;

}  // namespace shlight
