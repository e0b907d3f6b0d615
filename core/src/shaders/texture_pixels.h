// SPDX-License-Identifier: MIT
//
// Pictures with coarser levels of themselves.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace shlight {

enum class TextureInterpolation : std::uint8_t { closest, linear, cubic };
/// How a picture continues beyond coordinates 0 … 1.
enum class TextureExtension : std::uint8_t { repeat, extend, clip, mirror };

/// Meaning of a picture's numbers.
enum class TexelEncoding : std::uint8_t {
    linear,
    srgb  ///< red, green and blue are encoded as sRGB
};

/// A float of 16 bits (IEEE 754).
struct Half {
    std::uint16_t bits;
};

/// The numbers of a picture in the file's type. Integers represent 0 … 1.
using TexelNumbers =
    std::variant<std::vector<std::uint8_t>, std::vector<std::uint16_t>, std::vector<Half>, std::vector<float>>;

/// Reads RGBA of the texels of one level, which must outlive this.
class Texels {
  public:
    std::int64_t width, height;

    /// Prefetches the texels around a place 0 … 1 of the picture, which repeats beyond.
    void prefetch(const glm::vec2& place) const;
    /// Precondition: the texel is inside the picture.
    glm::vec4 operator()(std::int64_t column, std::int64_t row) const {
        const std::int64_t first = (row * width + column) * channels_;
        if (bytes_ != nullptr) {
            return of_bytes(bytes_ + first);
        }
        return floats_ != nullptr   ? of_numbers(floats_ + first)
               : halves_ != nullptr ? of_numbers(halves_ + first)
                                    : of_numbers(shorts_ + first);
    }

    /// Any texel, as the picture continues beyond its edges.
    glm::vec4 at(std::int64_t column, std::int64_t row, TextureExtension extension) const {
        const bool inside = column >= 0 && column < width && row >= 0 && row < height;
        return inside ? (*this)(column, row) : beyond(column, row, extension);
    }

  private:
    friend class TexturePixels;

    glm::vec4 beyond(std::int64_t column, std::int64_t row, TextureExtension extension) const;
    glm::vec4 of_bytes(const std::uint8_t* texel) const {
        const float* table = table_;
        if (channels_ == 1) {
            return glm::vec4(glm::vec3(table[texel[0]]), 1);
        }
        return {table[texel[0]], table[texel[1]], table[texel[2]],
                channels_ == 4 ? static_cast<float>(texel[3]) / 255 : 1.0F};
    }
    template <class Number>
    glm::vec4 of_numbers(const Number* texel) const;

    // One of these is not null.
    const std::uint8_t* bytes_;
    const std::uint16_t* shorts_;
    const Half* halves_;
    const float* floats_;
    const float* table_;  // value of each byte
    std::int64_t channels_;
    bool from_srgb_;
};

/// A picture with all its levels. Immutable; shared by all its users.
class TexturePixels {
  public:
    /// pixels: rows from v = 0 on with 1, 3 or 4 channels: grey, RGB, or RGB times alpha and alpha. NaN becomes 0;
    /// floats beyond ±kBrightest become that, and infinite halves the largest one. interpolation, extension: those of
    /// the textures; coarser levels are means of what they show.
    TexturePixels(TexelNumbers pixels, std::uint32_t width, std::uint32_t height, int channels, TexelEncoding encoding,
                  TextureInterpolation interpolation, TextureExtension extension);
    TexturePixels(const TexturePixels&) = delete;
    TexturePixels& operator=(const TexturePixels&) = delete;
    ~TexturePixels() = default;

    std::uint32_t width() const { return levels_.front().width; }
    std::uint32_t height() const { return levels_.front().height; }
    std::size_t level_count() const { return levels_.size(); }
    std::size_t size_in_bytes() const;
    TexelEncoding encoding() const { return encoding_; }

    /// The texels of a level, as stored or in linear light.
    const Texels& stored(std::size_t level) const { return stored_[level]; }
    const Texels& linear(std::size_t level) const { return linear_[level]; }

  private:
    /// A level, half as wide and high as the previous one, rounded up. Those after the first hold linear light, as
    /// halves where the picture has bytes: all texels of even parts of a picture would round in the same direction.
    struct Level {
        std::uint32_t width, height;
        int channels;
        TexelNumbers pixels;
    };
    void add(Level level);
    static Texels texels(const Level& level, const std::array<float, 256>& bytes);
    Level halved(std::size_t level, TextureInterpolation interpolation, TextureExtension extension) const;
    /// Whether numbers of a level are encoded as sRGB.
    bool is_srgb(std::size_t level) const { return level == 0 && encoding_ == TexelEncoding::srgb; }
    void store(Level& level, std::size_t texel, const glm::vec4& linear) const;

    std::vector<Level> levels_;
    std::vector<Texels> stored_, linear_;  // one for each level
    TexelEncoding encoding_;
};

/// Converts stored values to linear light.
glm::vec4 decoded(const glm::vec4& stored, TexelEncoding encoding);

}  // namespace shlight
