// SPDX-License-Identifier: MIT
//
// In which order a picture's pixels are rendered, and what is shown of those that are not rendered yet.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "film/pixel_batch.h"
#include "film/refinement.h"

namespace shlight {

/// Every step'th pixel of every step'th row, but those of a wider grid.
struct Grid {
    int step;
    int wider;  ///< the step of that; 0: there is none
};

struct Tile {
    int left, top, right, bottom;  // pixels; right and bottom excluded
};

/// Tiles of a picture, each with about as many pixels of the grid as a batch takes.
std::vector<Tile> tiles_of(int width, int height, const Grid& grid, std::uint32_t pixel_samples,
                           std::uint32_t batch_samples);
/// The pixels of a tile that are on a grid.
std::vector<Pixel> pixels_of(const Tile& tile, const Grid& grid);
/// Selects the pixels to render next, in blocks, so that pixels rendered together see the same objects: those with the
/// largest gain per ray, in this order. The result has no gains.
std::vector<RefinementGroup> most_urgent(std::span<const RefinementGroup> groups);
/// Interpolates between the pixels of a grid what these show beyond `base`, and adds it to base everywhere else.
/// image: RGBA; base: the same, or empty for black.
void fill_between(int step, int width, int height, int threads, std::span<const float> base, std::span<float> image);

}  // namespace shlight
