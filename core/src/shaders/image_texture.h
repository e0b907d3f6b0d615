// SPDX-License-Identifier: MIT
//
// Pictures that are looked up at texture coordinates, filtered by how far these move from camera ray to camera ray.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace shlight {

/// How far texture coordinates move from a camera ray to those of the neighbours.
struct TextureFootprint {
    glm::vec2 right{0}, below{0};
};

enum class TextureInterpolation : std::uint8_t { closest, linear, cubic };
/// What lies beyond 0 … 1.
enum class TextureExtension : std::uint8_t { repeat, extend, clip, mirror };

/// What the numbers of a picture mean.
enum class TexelEncoding : std::uint8_t {
    linear,
    srgb,   ///< red, green and blue are encoded as sRGB
    normal  ///< (n + 1) / 2 of unit vectors of three channels or more; alpha is the length of their mean
};

/// A float of 16 bits (IEEE 754).
struct Half {
    std::uint16_t bits;
};

/// The numbers of a picture, in the type of its file. Integers stand for 0 … 1.
using TexelNumbers =
    std::variant<std::vector<std::uint8_t>, std::vector<std::uint16_t>, std::vector<Half>, std::vector<float>>;

/// RGBA of the texels of one level, which must outlive this. Of unit vectors each is as long as the mean that it is.
class Texels {
  public:
    std::int64_t width, height;

    /// Asks for the texels about a place of the picture, which repeats from 0 … 1 on, ahead of their use.
    void prefetch(const glm::vec2& place) const;
    /// Precondition: inside.
    glm::vec4 operator()(std::int64_t column, std::int64_t row) const {
        const std::int64_t first = (row * width + column) * channels_;
        if (bytes_ != nullptr) {
            return of_bytes(bytes_ + first);
        }
        return floats_ != nullptr   ? of_numbers(floats_ + first)
               : halves_ != nullptr ? of_numbers(halves_ + first)
                                    : of_numbers(shorts_ + first);
    }

  private:
    friend class TexturePixels;

    glm::vec4 of_bytes(const std::uint8_t* texel) const {
        const float* table = table_;
        if (channels_ == 1) {
            return glm::vec4(glm::vec3(table[texel[0]]), 1);
        }
        const glm::vec4 color(table[texel[0]], table[texel[1]], table[texel[2]],
                              channels_ == 4 ? static_cast<float>(texel[3]) / 255 : 1.0F);
        return of_vectors_ ? vector(color) : color;
    }
    template <class Number>
    glm::vec4 of_numbers(const Number* texel) const;
    /// (n + 1) / 2 with n as long as it is to be.
    glm::vec4 vector(const glm::vec4& color) const;

    // One of these, the others are null.
    const std::uint8_t* bytes_;
    const std::uint16_t* shorts_;
    const Half* halves_;
    const float* floats_;
    const float* table_;  // what bytes stand for
    std::int64_t channels_;
    bool from_srgb_, of_vectors_, are_means_;
};

/// Immutable; shared by all who look it up.
class TexturePixels {
  public:
    /// pixels: rows from v = 0 on, of 1, 3 or 4 channels: grey, RGB, or RGB times alpha and alpha. What is not finite
    /// becomes 0, or the largest number of its type.
    TexturePixels(TexelNumbers pixels, std::uint32_t width, std::uint32_t height, int channels, TexelEncoding encoding);
    TexturePixels(const TexturePixels&) = delete;
    TexturePixels& operator=(const TexturePixels&) = delete;
    ~TexturePixels() = default;

    std::uint32_t width() const { return levels_.front().width; }
    std::uint32_t height() const { return levels_.front().height; }
    std::size_t level_count() const { return levels_.size(); }
    std::size_t size_in_bytes() const;
    TexelEncoding encoding() const { return encoding_; }

    /// The texels of a level: as stored, or in linear light.
    const Texels& stored(std::size_t level) const { return stored_[level]; }
    const Texels& linear(std::size_t level) const { return linear_[level]; }

  private:
    /// Half as wide and high as the one before, rounded up.
    struct Level {
        std::uint32_t width, height;
        /// Means of unit vectors have length 1 and √(1 - their length) as a fourth channel, which bytes resolve where
        /// the length is near 1.
        int channels;
        TexelNumbers pixels;
    };
    void add(Level level);
    static Texels texels(const Level& level, const std::array<float, 256>& bytes);
    Level halved(std::size_t level) const;
    void store(Level& level, std::size_t texel, const glm::vec4& linear) const;

    std::vector<Level> levels_;
    std::vector<Texels> stored_, linear_;  // of each level
    TexelEncoding encoding_;
};

/// Stored values as linear light.
glm::vec4 decoded(const glm::vec4& stored, TexelEncoding encoding);

class ImageTexture {
  public:
    struct Tile {
        std::int64_t u, v;  ///< covers u … u + 1
        std::shared_ptr<const TexturePixels> pixels;
    };
    /// tiles: one at (0, 0) that `extension` continues, or several that do not; between these is magenta.
    /// unassociate: colours are divided by alpha.
    ImageTexture(std::vector<Tile> tiles, TextureInterpolation interpolation, TextureExtension extension,
                 bool unassociate, bool tiled);

    const TexturePixels& pixels() const { return *tiles_.front().pixels; }
    /// A lookup but for the texels, which are on their way.
    struct Lookup {
        const TexturePixels* pixels;  ///< null: it is between the tiles
        glm::vec2 place;              ///< 0 … 1 over the picture
        float longest;                ///< side of the footprint, in texels
        float level;
        int probes;      ///< along that side; 0: the footprint is within a texel
        glm::vec2 step;  ///< from probe to probe
    };
    Lookup look(const glm::vec2& place, const TextureFootprint& footprint) const;
    /// Linear RGBA. Without a footprint it is what the interpolation makes of the picture.
    glm::vec4 read(const Lookup& lookup) const;
    glm::vec4 sample(const glm::vec2& place, const TextureFootprint& footprint) const {
        return read(look(place, footprint));
    }

  private:
    class Reader;
    glm::vec4 finished(const glm::vec4& stored, TexelEncoding encoding) const;

    std::vector<Tile> tiles_;
    TextureInterpolation interpolation_;
    TextureExtension extension_;
    bool unassociate_, tiled_;
};

}  // namespace shlight
