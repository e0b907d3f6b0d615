// SPDX-License-Identifier: MIT
//
// Pictures that are looked up at texture coordinates.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

namespace shlight {

/// How far texture coordinates move from pixel to pixel of the picture.
struct TextureFootprint {
    glm::vec2 right{0}, below{0};
};

enum class TextureInterpolation : std::uint8_t { closest, linear, cubic };
/// What lies beyond 0 … 1.
enum class TextureExtension : std::uint8_t { repeat, extend, clip, mirror };

class ImageTexture {
  public:
    /// pixels: linear RGBA of rows from v = 0 on.
    ImageTexture(std::vector<glm::vec4> pixels, std::uint32_t width, std::uint32_t height,
                 TextureInterpolation interpolation, TextureExtension extension);

    std::uint32_t width() const { return width_; }
    std::uint32_t height() const { return height_; }
    glm::vec4 sample(const glm::vec2& place, const TextureFootprint& footprint) const;

  private:
    glm::vec4 texel(std::int64_t column, std::int64_t row) const;

    std::vector<glm::vec4> pixels_;
    std::uint32_t width_, height_;
    TextureInterpolation interpolation_;
    TextureExtension extension_;
};

}  // namespace shlight
