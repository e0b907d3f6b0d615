// SPDX-License-Identifier: MIT
//
// Light given in harmonics, reflected by lobes with different frames, one lane for each lobe. Rotating a lobe of 64
// bands takes some 64³ products with matrices that all lobes share.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "math/band_rotation.h"
#include "math/legendre.h"
#include "shlight/types.h"

namespace shlight {

/// Harmonics of a light in three colour channels.
using ColorHarmonics = std::array<std::vector<float>, 3>;

/// A lobe's cosine terms, or its sine terms, 0 in bands that are not used, and the rotation from its frame to the
/// light's.
struct TurnedLobe {
    std::array<float, kCosineMax> terms;
    BandRotation rotation;
    float sine = 0;  ///< 1: the terms are of degrees -m, and those of m = 0 are 0
};

/// The number of lobes in a call is a multiple of this.
inline constexpr std::size_t kTurnedLanes = 16;

/// reflected[i]: Eq. 5 of the paper for lobes[i], summed over the bands below `order`.
void reflect_turned(std::span<const TurnedLobe> lobes, int order, const ColorHarmonics& light,
                    std::span<Rgb> reflected);

}  // namespace shlight
