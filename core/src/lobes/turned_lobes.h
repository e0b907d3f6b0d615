// SPDX-License-Identifier: MIT
//
// What lobes of any frames reflect of one light's harmonics: in lanes, one for each lobe. Turning a lobe of 64 bands
// takes some 64³ products, by matrices that all lobes share.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "lobes/rotated_lobe.h"
#include "math/band_rotation.h"
#include "math/legendre.h"
#include "shlight/types.h"

namespace shlight {

/// The cosine terms of a lobe, those of all bands that it is not turned in 0, and the way from its frame to the
/// light's.
struct TurnedLobe {
    std::array<float, kCosineMax> terms;
    BandRotation rotation;
};

/// Lobes of one call are a multiple of this.
inline constexpr std::size_t kTurnedLanes = 16;

/// Of the bands below an order.
void reflect_turned(std::span<const TurnedLobe> lobes, int order, const ColorHarmonics& light,
                    std::span<Rgb> reflected);

}  // namespace shlight
