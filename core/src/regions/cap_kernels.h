// SPDX-License-Identifier: MIT
//
// Kernels over many caps: their coefficients, and their product with lobes in one pass.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "regions/cap_arrays.h"
#include "shlight/types.h"
#include "simd/lobe_arrays.h"

namespace shlight {

/// order² coefficients of cap i, or of the cap that sphere i covers, at rows + i · order².
void cap_rows(const CapArrays& caps, std::size_t count, int order, bool clip, float* rows, Output output);
void cap_rows(const CapArrays& caps, std::size_t count, int order, bool clip, double* rows, Output output);
void cap_rows(const SphereArrays& spheres, std::size_t count, int order, bool clip, float* rows, Output output);

/// values[i] = Σ f_lm L_lm of cap cap_of[i] for the lobe at view view_of[i], clipped by the horizon and seen through
/// the view's boost. Lights that need the same are put together: hidden, crossing, and others.
void shade_caps(const CapArrays& caps, std::span<const std::uint32_t> cap_of, const LobeArrays& lobe,
                std::span<const std::uint32_t> view_of, std::span<float> values);
/// The same for sphere i, whose cap no one else needs, at view view_of[i].
void shade_caps(const SphereArrays& spheres, const LobeArrays& lobe, std::span<const std::uint32_t> view_of,
                std::span<float> values);

}  // namespace shlight
