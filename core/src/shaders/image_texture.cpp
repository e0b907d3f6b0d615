// SPDX-License-Identifier: MIT
#include "shaders/image_texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

namespace shlight {
namespace {

/// Maximum number of look-ups along the longer side of a footprint; longer footprints are also blurred across.
constexpr float kMostProbes = 24;
/// Texel coordinates beyond this lie further apart than one texel in float.
constexpr float kFarthestTexel = 1e7F;

constexpr glm::vec4 kMissing(1, 0, 1, 1);

/// Weights of a uniform cubic B-spline.
std::array<float, 4> cubic_weights(float t) {
    const float s = 1 - t;
    return {s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (3 * s * s * s - 6 * s * s + 4) / 6, t * t * t / 6};
}

}  // namespace

/// Reads one picture, continued beyond its edges. Places are in texels of the level.
class ImageTexture::Reader {
  public:
    Reader(const TexturePixels& pixels, TextureInterpolation interpolation, TextureExtension extension)
        : pixels_(&pixels), interpolation_(interpolation), extension_(extension) {}

    /// The stored value at a place, as Cycles interpolates it.
    glm::vec4 interpolated(const glm::vec2& place) const {
        return interpolation_ == TextureInterpolation::closest  ? closest(place)
               : interpolation_ == TextureInterpolation::linear ? bilinear(pixels_->stored(0), place)
                                                                : cubic(place);
    }
    /// Linear light, interpolated between two levels; place: 0 … 1 over the picture.
    glm::vec4 trilinear(float level, const glm::vec2& place) const {
        const auto low = static_cast<std::size_t>(level);
        const float share = level - static_cast<float>(low);
        const glm::vec4 fine = at_level(low, place);
        return share > 0 ? glm::mix(fine, at_level(low + 1, place), share) : fine;
    }

  private:
    /// The stored value of the closest texel.
    glm::vec4 closest(const glm::vec2& place) const {
        return texel(pixels_->stored(0), static_cast<std::int64_t>(std::floor(place.x)),
                     static_cast<std::int64_t>(std::floor(place.y)));
    }
    glm::vec4 cubic(const glm::vec2& place) const {
        const Texels& texels = pixels_->stored(0);
        const Corner corner(place);
        const std::array<float, 4> wx = cubic_weights(corner.share.x);
        const std::array<float, 4> wy = cubic_weights(corner.share.y);
        glm::vec4 sum(0);
        for (int j = 0; j < 4; ++j) {
            for (int i = 0; i < 4; ++i) {
                sum += wx[static_cast<std::size_t>(i)] * wy[static_cast<std::size_t>(j)] *
                       texel(texels, corner.x + i - 1, corner.y + j - 1);
            }
        }
        return sum;
    }
    /// The texel to the lower left of a place, and the weights of the texels to the right and above.
    struct Corner {
        explicit Corner(const glm::vec2& place) {
            const glm::vec2 low = glm::floor(place - 0.5F);
            share = place - 0.5F - low;
            x = static_cast<std::int64_t>(low.x);
            y = static_cast<std::int64_t>(low.y);
        }
        std::int64_t x, y;
        glm::vec2 share{};
    };

    glm::vec4 at_level(std::size_t level, const glm::vec2& place) const {
        const Texels& texels = pixels_->linear(level);
        const glm::vec2 inside = place * glm::vec2(texels.width, texels.height);
        const bool is_decoded_last = level == 0 && pixels_->encoding() == TexelEncoding::srgb;
        return is_decoded_last && interpolation_ != TextureInterpolation::closest
                   ? decoded(interpolated(inside), TexelEncoding::srgb)
                   : bilinear(texels, inside);
    }
    glm::vec4 bilinear(const Texels& texels, const glm::vec2& place) const {
        const Corner c(place);
        const bool inside = c.x >= 0 && c.y >= 0 && c.x + 1 < texels.width && c.y + 1 < texels.height;
        const auto read = [&](std::int64_t x, std::int64_t y) { return inside ? texels(x, y) : texel(texels, x, y); };
        const glm::vec2 rest = 1.0F - c.share;
        return rest.y * (rest.x * read(c.x, c.y) + c.share.x * read(c.x + 1, c.y)) +
               c.share.y * (rest.x * read(c.x, c.y + 1) + c.share.x * read(c.x + 1, c.y + 1));
    }
    glm::vec4 texel(const Texels& texels, std::int64_t column, std::int64_t row) const {
        return texels.at(column, row, extension_);
    }

    const TexturePixels* pixels_;
    TextureInterpolation interpolation_;
    TextureExtension extension_;
};

ImageTexture::ImageTexture(std::vector<Tile> tiles, TextureInterpolation interpolation, TextureExtension extension,
                           bool unassociate, bool tiled)
    : tiles_(std::move(tiles)),
      interpolation_(interpolation),
      extension_(extension),
      unassociate_(unassociate),
      tiled_(tiled) {}

glm::vec4 ImageTexture::finished(const glm::vec4& stored, TexelEncoding encoding) const {
    glm::vec4 color = stored;
    if (unassociate_ && color.w != 0 && color.w != 1) {
        color = {color.x / color.w, color.y / color.w, color.z / color.w, color.w};
    }
    return decoded(color, encoding);
}

/// Along which axes the picture is not constant over a footprint, as 1 or 0. Beyond an edge that is extended only the
/// outermost texels are seen, which coarser levels have mixed with those further in.
glm::vec2 ImageTexture::varies_along(const glm::vec2& place, const TextureFootprint& footprint) const {
    if (extension_ != TextureExtension::extend) {
        return glm::vec2(1);
    }
    const glm::vec2 half = 0.5F * (glm::abs(footprint.right) + glm::abs(footprint.below));
    return glm::vec2(glm::lessThanEqual(glm::abs(place - 0.5F), 0.5F + half));
}

ImageTexture::Lookup ImageTexture::look(const glm::vec2& place, const TextureFootprint& footprint) const {
    const Tile* tile = &tiles_.front();
    glm::vec2 inside = place;
    if (tiled_) {
        const glm::vec2 number = glm::floor(inside);
        const auto found = std::find_if(tiles_.begin(), tiles_.end(), [&](const Tile& t) {
            return static_cast<float>(t.u) == number.x && static_cast<float>(t.v) == number.y;
        });
        if (found == tiles_.end()) {
            return {};
        }
        tile = &*found;
        inside -= number;
    }
    const TexturePixels& pixels = *tile->pixels;
    const glm::vec2 size(pixels.width(), pixels.height());
    const glm::vec2 texels = inside * size;
    if (!(std::abs(texels.x) < kFarthestTexel && std::abs(texels.y) < kFarthestTexel)) {
        inside = glm::vec2(0);
    }
    const glm::vec2 varies = varies_along(inside, footprint);
    glm::vec2 along = footprint.right * size * varies;
    glm::vec2 across = footprint.below * size * varies;
    if (glm::dot(along, along) < glm::dot(across, across)) {
        std::swap(along, across);
    }
    Lookup lookup = {&pixels, inside, 0, 0, glm::vec2(0)};
    const float longest = glm::length(along);
    if (longest > 1) {
        // Width of the footprint: its area ÷ its longest side. It is NaN where a neighbour's coordinate is, and max()
        // then leaves it out because it comes last.
        const float width = std::abs(along.x * across.y - along.y * across.x) / longest;
        const float least = std::max({1.0F, longest / kMostProbes, width});
        const auto top = static_cast<float>(pixels.level_count() - 1);
        lookup.level = std::isfinite(least) ? std::clamp(std::log2(least), 0.0F, top) : top;
        lookup.probes = std::isfinite(longest) ? static_cast<int>(std::ceil(longest / least)) : 1;
        lookup.step = std::isfinite(longest) ? along / size / static_cast<float>(lookup.probes) : glm::vec2(0);
    }
    const auto low = static_cast<std::size_t>(lookup.level);
    pixels.linear(low).prefetch(inside);
    if (lookup.level > static_cast<float>(low)) {
        pixels.linear(low + 1).prefetch(inside);
    }
    return lookup;
}

glm::vec4 ImageTexture::read(const Lookup& lookup) const {
    if (lookup.pixels == nullptr) {
        return kMissing;
    }
    const Reader reader(*lookup.pixels, interpolation_, extension_);
    const TexelEncoding encoding = lookup.pixels->encoding();
    if (lookup.probes == 0) {
        const glm::vec2 texels = lookup.place * glm::vec2(lookup.pixels->width(), lookup.pixels->height());
        return finished(reader.interpolated(texels), encoding);
    }
    glm::vec4 sum(0);
    for (int i = 0; i < lookup.probes; ++i) {
        const float from_middle = static_cast<float>(i) + 0.5F - 0.5F * static_cast<float>(lookup.probes);
        sum += reader.trilinear(lookup.level, lookup.place + from_middle * lookup.step);
    }
    sum /= static_cast<float>(lookup.probes);
    if (unassociate_ && sum.w > 0) {
        sum = glm::vec4(glm::vec3(sum) / sum.w, sum.w);
    }
    return sum;
}

}  // namespace shlight
