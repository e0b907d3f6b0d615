// SPDX-License-Identifier: MIT
//
// Gabor noise as operations of shader programs.
#pragma once

#include <cstddef>

#include "shaders/operations.h"

namespace shlight {

/// Sums of Gabor kernels around eight random places in each cell of a grid of two or three dimensions (Lagae et al.
/// 2009, Procedural Noise using Sparse Gabor Convolution, Eq. 8; Tavernier et al. 2019, Making Gabor Noise Fast and
/// Normalized), as phasors (Tricard et al. 2019, Procedural Phasor Noise, Section 3.1.1).
/// Arguments: the coordinates, frequency, isotropy, and angles of the orientation: of two dimensions the one to x, of
/// three those to z and around it. Results: cosine part and sine part.
template <std::size_t kDimensions>
void gabor(const OperationLanes& lanes);

}  // namespace shlight
