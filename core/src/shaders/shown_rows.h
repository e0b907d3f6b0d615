// SPDX-License-Identifier: MIT
//
// The means of a picture about its texels, from which coarser levels are made.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "shaders/texture_pixels.h"

namespace shlight {

/// Linear light of a picture as it is shown, row by row. Numbers in sRGB are interpolated before they are decoded: a
/// picture is darker than the mean of its texels, white noise by a fifth.
class ShownRows {
  public:
    /// stored, linear: the picture's texels, which must outlive this. is_srgb: how they are stored.
    ShownRows(const Texels& stored, const Texels& linear, bool is_srgb, TextureInterpolation interpolation,
              TextureExtension extension)
        : stored_(&stored),
          linear_(&linear),
          interpolation_(interpolation),
          extension_(extension == TextureExtension::clip ? TextureExtension::extend : extension),
          by_cells_(is_srgb && interpolation != TextureInterpolation::closest) {}

    /// Rows 0, 1, …, each as often as it is needed before the next.
    const std::vector<glm::vec4>& row(std::int64_t y);

  private:
    using Colors = std::vector<glm::vec3>;

    /// Linear light along the middles of a row's texels, or halfway to the next row: at the middle of each texel, from
    /// one before the first to one behind the last, and halfway to the next one.
    Colors line(std::int64_t y, bool halfway) const;
    /// Means over the cells between the middles of a row's texels, where this is shown, and of the next row's.
    Colors means(std::int64_t y, const Colors& below, const Colors& above) const;

    const Texels* stored_;
    const Texels* linear_;
    TextureInterpolation interpolation_;
    TextureExtension extension_;  // what is clipped is cut off where levels are read
    bool by_cells_;
    std::int64_t y_ = -1;
    std::vector<glm::vec4> values_;  // of row y_
    Colors above_;                   // line of row y_ + 1
    std::array<Colors, 2> cells_;    // below and above the middles of row y_
};

}  // namespace shlight
