// SPDX-License-Identifier: MIT
//
// Scripts of shader programs: instructions with loops, which are interpreted for several hits at a time.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "shaders/operations.h"

namespace shlight {

/// Names of what instructions do, which their first word is the index of.
std::span<const std::string_view> script_instructions();

/// Throws std::invalid_argument for a script that would reach beyond its registers or instructions.
void check_script(const ShaderScript& script);

/// The operation of shader programs: its arguments are the script's.
void run_script(const OperationLanes& lanes);

}  // namespace shlight
