// SPDX-License-Identifier: MIT
//
// In which order a picture's pixels are rendered, and what is shown of those that are not rendered yet.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
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
/// The place of a pixel between the pixels of a grid.
class GridPlace {
  public:
    GridPlace(const Pixel& pixel, int step, int width, int height);

    std::size_t pixel() const { return pixel_; }
    std::size_t nearest() const { return corners_[(across_ < 0.5F ? 0 : 1) + (down_ < 0.5F ? 0 : 2)]; }
    bool is_on_grid() const { return across_ == 0 && down_ == 0; }
    /// Interpolates between the values of the pixels around.
    template <class Value>
    float between(const Value& value) const {
        return std::lerp(std::lerp(value(corners_[0]), value(corners_[1]), across_),
                         std::lerp(value(corners_[2]), value(corners_[3]), across_), down_);
    }
    /// Gives the pixel what lies between those around it, in each channel. image: pixels × channels.
    void fill(std::size_t channels, std::span<float> image) const { fill(channels, 0, channels, image); }
    /// The same for some channels.
    void fill(std::size_t channels, std::size_t first, std::size_t count, std::span<float> image) const;

  private:
    std::size_t pixel_;
    std::array<std::size_t, 4> corners_;  // pixels
    float across_, down_;                 // between them
};

/// Interpolates between the pixels of a grid what these show beyond `base`, and adds it to base everywhere else.
/// image: RGBA; base: the same, or empty for black.
void fill_between(int step, int width, int height, int threads, std::span<const float> base, std::span<float> image);

}  // namespace shlight
