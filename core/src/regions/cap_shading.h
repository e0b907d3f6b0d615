// SPDX-License-Identifier: MIT
//
// What many lobes receive from many caps: light coefficients and their product with a lobe's in one pass.
#pragma once

#include <cstdint>
#include <span>

#include "regions/cap_arrays.h"
#include "simd/lobe_arrays.h"

namespace shlight {

/// values[i] = Σ f_lm L_lm of the cap inside circle circle_of[i] for the lobe at view view_of[i], clipped by the
/// horizon and seen through the view's boost. Lights that need the same are put together: hidden, crossing, and others.
void shade_caps(const CapArrays& circles, std::span<const std::uint32_t> circle_of, const LobeArrays& lobe,
                std::span<const std::uint32_t> view_of, std::span<float> values);

/// The same for sphere i, whose circle no one else needs, at view view_of[i].
void shade_caps(const SphereArrays& spheres, const LobeArrays& lobe, std::span<const std::uint32_t> view_of,
                std::span<float> values);

}  // namespace shlight
