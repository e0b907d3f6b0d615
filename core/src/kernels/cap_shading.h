// SPDX-License-Identifier: MIT
//
// TEMPORARY: the contract's interface over the scalar code.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "kernels/lobe_arrays.h"
#include "shlight/types.h"

namespace shlight {

struct CircleArrays {
    const double *x, *y, *z, *cosine, *sine;
};

void shade_caps(const CircleArrays& circles, std::span<const std::uint32_t> circle_of, const LobeArrays& lobe,
                std::span<const std::uint32_t> view_of, std::span<float> values);

}  // namespace shlight
