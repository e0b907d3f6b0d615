// SPDX-License-Identifier: MIT
//
// Fresnel's factor of a surface under a thin film, as an operation of shader programs (Belcour & Barla 2017, "A
// Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence").
#pragma once

#include <cstddef>
#include <cstdint>

#include "shaders/operations.h"

namespace shlight {

/// The table of a film: for R, G and B the real parts, then the imaginary parts of the mean of exp(2πi D / λ) over what
/// the channel sees of wavelengths λ, in even steps of the path difference D from 0 to kLongestPath.
inline constexpr std::uint32_t kFilmRows = 6;
inline constexpr double kLongestPath = 1e4;  // [nm]

inline constexpr std::size_t kFilmArguments = 16, kFilmResults = 21;
/// Arguments: cosθ_o and α of a lobe of GGX; the film's thickness [nm] and index; and three times, for R, G and B, of
/// what is below the film n, k, the reflectance at cosθ_d = 1/7 that a metal has without film (below 0: by Fresnel's
/// equations), and by what the factor is multiplied where it is that of a surface without film seen head-on.
/// Results: colours times 1, 1-c, (1-c)⁵, and c (1-c)ⁿ with n = 2, 3, 6 and 12, c = cosθ_d, whose sum is the factor by
/// least squares over the microfacets that are seen; of α = 0 the factor at cosθ_o times 1.
void thin_film(const OperationLanes& lanes);

}  // namespace shlight
