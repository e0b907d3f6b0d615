// SPDX-License-Identifier: MIT
//
// Sums of gradient noise of growing frequency, as operations of shader programs.
//
// The noise is that of K. Perlin, "Improving Noise" (SIGGRAPH 2002): gradients at the points of a lattice, weighted by
// 6t⁵ - 15t⁴ + 10t³ between them. It is 0 at the lattice's points, 0 on average, and scaled to about -1 … 1. Octaves
// are combined as F. K. Musgrave does in D. Ebert et al., "Texturing and Modeling: A Procedural Approach" (1994),
// chapter "Procedural Fractal Terrains".
#pragma once

#include <cstddef>
#include <cstdint>

#include "shaders/operations.h"

namespace shlight {

/// How octaves, each of `roughness` times the strength and `lacunarity` times the frequency of the one before, become
/// one number.
enum class Fractal : std::uint8_t {
    fbm,             ///< their sum (fractional Brownian motion), brought to 0 … 1
    fbm_loss,        ///< variance, over places, of what a footprint takes from 2 fbm
    fbm_sum,         ///< their sum
    musgrave_sum,    ///< the same, but places are rounded after each octave, and not the frequency
    multifractal,    ///< the product of 1 plus each
    hetero_terrain,  ///< each adds in proportion to the sum before it
    hybrid,          ///< each adds in proportion to the one before it
    ridged           ///< the same of (offset - |noise|)²
};
inline constexpr std::uint32_t kFractals = 8;

/// A fractal, which the mode is the number of, at places of 1 … 4 coordinates. Arguments: the place, octaves (0 … 16,
/// the last one in part if it is no integer), roughness, lacunarity, offset, gain, period after which the pattern
/// repeats (0: never), and the results of a footprint, over which the result is a mean. What of an octave is finer is
/// taken for its mean. Places that are not finite count as 0.
template <std::size_t kCount>
void noise(const OperationLanes& lanes);

/// Arguments: differences of a place to the right and below. Results: the trace and the determinant of their matrix of
/// scalar products, and the longer axis of the ellipse that it stands for. Without an axis, fractals are looked up at
/// one place.
template <std::size_t kCount>
void footprint(const OperationLanes& lanes);

}  // namespace shlight
