// SPDX-License-Identifier: MIT
//
// Which pixels take more camera rays: where those that they have taken, or those of a neighbour, disagree so much that
// the mean may be wrong.
//
// The mean of n rays spread evenly over a pixel of variance v is wrong by about √v n^-3/4: an edge crosses some √n of
// n cells, and errs in each by a random part of it. What counts is this error relative to √(r² + 0.01 r̄²), as in
// relMSE, r the pixel's own value and r̄ the picture's mean after the first pass; and that of alpha. A pixel whose rays
// agree may still hold something thin or bright that a neighbour has seen.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/pixel_batch.h"

namespace shlight {

/// Pixels that go from one level to a higher one; one of level l has base_samples · 4^l rays, one of -1 none.
struct RefinementGroup {
    int from, to;
    std::vector<Pixel> pixels;  // in rows
};

class Refinement {
  public:
    Refinement(int width, int height, std::uint32_t base_samples, int most_level);

    /// Merges the rays that take a pixel to a level into its mean, alpha and variance. Other pixels may be merged at
    /// the same time.
    void merge(const Pixel& pixel, int level, const PixelSums& sums, std::span<float> image);
    /// What is compared with the picture as it now is.
    void set_mean(std::span<const float> image);
    /// What must be rendered next; empty: nothing.
    std::vector<RefinementGroup> next_round(std::span<const float> image) const;
    std::uint32_t samples(int level) const { return level < 0 ? 0 : base_samples_ << (2 * level); }

  private:
    struct State {
        Rgb variance{0};
        int level = -1;
    };

    std::size_t index(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(column);
    }
    int wanted_level(int column, int row, std::span<const float> image) const;
    int sufficient_level(double variance) const;
    double neighbours_variance(int column, int row, const Vec3d& scale, std::span<const float> image) const;

    int width_, height_;
    std::uint32_t base_samples_;
    int most_level_;
    double least_square_ = 0;  // 0.01 r̄²
    std::vector<State> states_;
};

}  // namespace shlight
