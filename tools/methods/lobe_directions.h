// SPDX-License-Identifier: MIT
//
// The directions ω_d of zonal harmonic factorization (Nowrouzezahrai, Simari & Fiume 2012; Zhou & Wei 2020, Eq. 6).
//
// Band l is the span of the 2l + 1 zonal functions about the first 2l + 1 directions, so that an order n takes the
// first 2n - 1 and every order the same ones. docs/figures/lobe_directions.py found them: they keep small the condition
// numbers of the matrices Y_lm(ω_d), which multiply every error of the zonal integrals.
#pragma once

#include <array>

#include "shlight/types.h"

namespace shlight::methods {

/// The highest order of the zonal methods: bands 0 … 31.
inline constexpr int kMaxZonalOrder = 32;

/// Number of lobes of an order.
constexpr int lobe_count(int order) {
    return 2 * order - 1;
}

inline constexpr std::size_t kMaxLobes = lobe_count(kMaxZonalOrder);

/// Unit vectors.
const std::array<Vec3d, kMaxLobes>& lobe_directions();

}  // namespace shlight::methods
