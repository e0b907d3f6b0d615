// SPDX-License-Identifier: MIT
//
// Passes of a whole picture, as means over the camera rays that pixels have had so far.
#pragma once

#include <cstddef>
#include <span>

#include "film/pixel_order.h"
#include "shlight/render_passes.h"

namespace shlight {

/// Adds a share to that of an identity among pairs (identity, share), or to the last of them if there is no room.
void add_to_matte(std::span<double> pairs, double identity, double share);

/// Whether a pass is one of Cryptomatte's.
bool is_matte(Pass kind);
/// Whether a pass has the value of the ray through the pixel's middle, and is no mean.
bool is_of_middle(Pass kind);
/// Whether a pass is a guide of the denoiser, which a pixel has from its middle until it has rays.
bool is_guide(Pass kind);

/// Refers to the values.
class PassImage {
  public:
    /// values: pixels × layout.stride(), 0 at first.
    PassImage(const PassLayout& layout, std::span<float> values) : layout_(&layout), values_(values) {}

    bool empty() const { return layout_->empty(); }
    std::size_t stride() const { return layout_->stride(); }
    std::span<float> pixel(std::size_t index) const { return pixels(index, 1); }
    std::span<float> pixels(std::size_t first, std::size_t count) const {
        return values_.subspan(first * stride(), count * stride());
    }
    /// Makes sums over more of a pixel's rays part of its means, which are those of `before` of `all` rays. Other
    /// pixels may be merged at the same time.
    void merge(std::size_t index, double before, double all, std::span<const double> sums) const;
    /// Gives a pixel without a ray what lies between those of a grid around it, but not what write_middles() knows.
    void fill(const GridPlace& place) const;
    /// Makes of the means of all pixels what passes promise. No more pixels may be merged.
    void finish(int threads) const;

  private:
    void finish(std::span<float> pixel) const;

    const PassLayout* layout_;
    std::span<float> values_;
};

}  // namespace shlight
