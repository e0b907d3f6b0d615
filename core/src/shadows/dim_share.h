// SPDX-License-Identifier: MIT
//
// How many rays a light is worth that adds little to a pixel. It is never dropped; fewer rays tell how much of it is
// seen.
#pragma once

#include <cmath>
#include <cstddef>

namespace shlight {

/// A light that adds less than this to a pixel is asked for at fewer of its hits: what its visibility is then off by is
/// no more than that of a light of this share, and of many such lights the errors go both ways. The variance of their
/// sum, over its square, is below this share / (4 · hits), however many they are: each adds its own share times this
/// share / hits, times p (1 - p) ≤ 1/4 if it is seen from p of the pixel.
inline constexpr float kDimShare = 0.01F;

/// Hits at which to ask: 1 … hits. own: brightness of the light over the pixel; all: that of all lights.
inline std::size_t hits_to_ask(float own, float all, std::size_t hits) {
    const float least = kDimShare * all;
    return own < least ? static_cast<std::size_t>(std::ceil(own / least * static_cast<float>(hits))) : hits;
}

}  // namespace shlight
