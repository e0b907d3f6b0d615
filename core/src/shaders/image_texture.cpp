// SPDX-License-Identifier: MIT
#include "shaders/image_texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace shlight {
namespace {

/// Lookups along the longer side of a footprint, at most; what is longer is blurred across, too.
constexpr float kMostProbes = 24;
/// Texel coordinates beyond this are not told apart by floats.
constexpr float kFarthest = 1e7F;

constexpr glm::vec4 kMissing(1, 0, 1, 1);

float linear_from_srgb(float encoded) {
    return encoded <= 0.04045F ? std::max(encoded, 0.0F) / 12.92F : std::pow((encoded + 0.055F) / 1.055F, 2.4F);
}

float srgb_from_linear(float linear) {
    return linear <= 0.0031308F ? 12.92F * linear : 1.055F * std::pow(linear, 1 / 2.4F) - 0.055F;
}

const std::array<float, 256>& srgb_bytes() {
    static const std::array<float, 256> table = [] {
        std::array<float, 256> values{};
        for (std::size_t i = 0; i < values.size(); ++i) {
            values[i] = linear_from_srgb(static_cast<float>(i) / 255);
        }
        return values;
    }();
    return table;
}

float finite(float value) {
    return std::isnan(value)
               ? 0.0F
               : std::clamp(value, std::numeric_limits<float>::lowest(), std::numeric_limits<float>::max());
}

glm::vec4 encoded(const glm::vec4& linear, TexelEncoding encoding) {
    return encoding != TexelEncoding::srgb ? linear
                                           : glm::vec4(srgb_from_linear(linear.x), srgb_from_linear(linear.y),
                                                       srgb_from_linear(linear.z), linear.w);
}

/// Of a uniform cubic B-spline.
std::array<float, 4> cubic_weights(float t) {
    const float s = 1 - t;
    return {s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (3 * s * s * s - 6 * s * s + 4) / 6, t * t * t / 6};
}

}  // namespace

glm::vec4 decoded(const glm::vec4& stored, TexelEncoding encoding) {
    return encoding != TexelEncoding::srgb ? stored
                                           : glm::vec4(linear_from_srgb(stored.x), linear_from_srgb(stored.y),
                                                       linear_from_srgb(stored.z), stored.w);
}

TexturePixels::TexturePixels(std::variant<Bytes, Floats> pixels, std::uint32_t width, std::uint32_t height,
                             int channels, TexelEncoding encoding)
    : channels_(channels), encoding_(encoding) {
    if (auto* floats = std::get_if<Floats>(&pixels)) {
        std::transform(floats->begin(), floats->end(), floats->begin(), finite);
    }
    levels_.push_back({width, height, std::move(pixels)});
    while (levels_.back().width > 1 || levels_.back().height > 1) {
        levels_.push_back(halved(levels_.size() - 1));
    }
}

std::size_t TexturePixels::size_in_bytes() const {
    std::size_t bytes = 0;
    for (const Level& level : levels_) {
        const auto* floats = std::get_if<Floats>(&level.pixels);
        bytes += floats != nullptr ? floats->size() * sizeof(float) : std::get<Bytes>(level.pixels).size();
    }
    return bytes;
}

glm::vec4 TexturePixels::stored(std::size_t level, std::int64_t column, std::int64_t row) const {
    const Level& own = levels_[level];
    const auto count = static_cast<std::size_t>(channels_);
    const std::size_t first = (static_cast<std::size_t>(row) * own.width + static_cast<std::size_t>(column)) * count;
    const auto value = [&](std::size_t i) {
        const auto* bytes = std::get_if<Bytes>(&own.pixels);
        return bytes != nullptr ? static_cast<float>((*bytes)[first + i]) * (1 / 255.0F)
                                : std::get<Floats>(own.pixels)[first + i];
    };
    if (count == 1) {
        return glm::vec4(glm::vec3(value(0)), 1);
    }
    return {value(0), value(1), value(2), count == 4 ? value(3) : 1.0F};
}

glm::vec4 TexturePixels::linear(std::size_t level, std::int64_t column, std::int64_t row) const {
    const glm::vec4 texel = stored(level, column, row);
    if (encoding_ == TexelEncoding::srgb) {
        if (std::holds_alternative<Bytes>(levels_[level].pixels)) {
            const auto& table = srgb_bytes();
            const auto at = [&](float x) { return table[static_cast<std::size_t>(std::lround(x * 255))]; };
            return {at(texel.x), at(texel.y), at(texel.z), texel.w};
        }
        return decoded(texel, encoding_);
    }
    if (encoding_ == TexelEncoding::normal && level == 0) {
        const glm::vec3 n = glm::vec3(texel) * 2.0F - 1.0F;
        const float length = glm::length(n);
        return length > 0 ? glm::vec4(n / length * 0.5F + 0.5F, texel.w) : texel;
    }
    return texel;
}

void TexturePixels::store(Level& level, std::size_t texel, const glm::vec4& linear) const {
    const glm::vec4 value = encoded(linear, encoding_);
    for (int i = 0; i < channels_; ++i) {
        const std::size_t at = texel * static_cast<std::size_t>(channels_) + static_cast<std::size_t>(i);
        if (auto* bytes = std::get_if<Bytes>(&level.pixels)) {
            (*bytes)[at] = static_cast<std::uint8_t>(std::lround(std::clamp(value[i], 0.0F, 1.0F) * 255));
        } else {
            std::get<Floats>(level.pixels)[at] = value[i];
        }
    }
}

/// Each texel is the mean over its share of the area, also where a side is odd.
TexturePixels::Level TexturePixels::halved(std::size_t level) const {
    const Level& from = levels_[level];
    Level to = {(from.width + 1) / 2, (from.height + 1) / 2, {}};
    const std::size_t count = std::size_t{to.width} * to.height * static_cast<std::size_t>(channels_);
    if (std::holds_alternative<Bytes>(from.pixels)) {
        to.pixels = Bytes(count);
    } else {
        to.pixels = Floats(count);
    }
    // Part i of `parts` covers i size/parts … (i + 1) size/parts, which is at most three texels.
    struct Cover {
        std::int64_t first;
        std::array<float, 3> weights;
    };
    const auto cover = [](std::uint32_t i, std::uint32_t parts, std::uint32_t size) {
        const double step = static_cast<double>(size) / parts;
        const double begin = i * step;
        Cover result = {static_cast<std::int64_t>(begin), {}};
        for (int k = 0; k < 3; ++k) {
            const auto texel = static_cast<double>(result.first + k);
            const double part = std::min(texel + 1, begin + step) - std::max(texel, begin);
            result.weights[static_cast<std::size_t>(k)] = static_cast<float>(std::max(part, 0.0) / step);
        }
        return result;
    };
    std::vector<Cover> columns;
    for (std::uint32_t x = 0; x < to.width; ++x) {
        columns.push_back(cover(x, to.width, from.width));
    }
    for (std::uint32_t y = 0; y < to.height; ++y) {
        const Cover rows = cover(y, to.height, from.height);
        for (std::uint32_t x = 0; x < to.width; ++x) {
            glm::vec4 sum(0);
            for (int j = 0; j < 3; ++j) {
                for (int i = 0; i < 3; ++i) {
                    const float weight =
                        rows.weights[static_cast<std::size_t>(j)] * columns[x].weights[static_cast<std::size_t>(i)];
                    if (weight > 1e-6F) {
                        sum += weight * linear(level, std::min<std::int64_t>(columns[x].first + i, from.width - 1),
                                               std::min<std::int64_t>(rows.first + j, from.height - 1));
                    }
                }
            }
            store(to, std::size_t{y} * to.width + x, sum);
        }
    }
    return to;
}

/// One picture, continued beyond its edges.
class ImageTexture::Lookup {
  public:
    Lookup(const TexturePixels& pixels, TextureExtension extension) : pixels_(&pixels), extension_(extension) {}

    /// As stored, at a place in texels of the base.
    glm::vec4 closest(const glm::vec2& texels) const {
        return texel<false>(0, static_cast<std::int64_t>(std::floor(texels.x)),
                            static_cast<std::int64_t>(std::floor(texels.y)));
    }
    glm::vec4 cubic(const glm::vec2& texels) const {
        const glm::vec2 corner = glm::floor(texels - 0.5F);
        const glm::vec2 t = texels - 0.5F - corner;
        const std::array<float, 4> wx = cubic_weights(t.x);
        const std::array<float, 4> wy = cubic_weights(t.y);
        glm::vec4 sum(0);
        for (int j = 0; j < 4; ++j) {
            for (int i = 0; i < 4; ++i) {
                sum += wx[static_cast<std::size_t>(i)] * wy[static_cast<std::size_t>(j)] *
                       texel<false>(0, static_cast<std::int64_t>(corner.x) + i - 1,
                                    static_cast<std::int64_t>(corner.y) + j - 1);
            }
        }
        return sum;
    }
    /// kLinear: in linear light, or else as stored.
    template <bool kLinear>
    glm::vec4 bilinear(std::size_t level, const glm::vec2& texels) const {
        const glm::vec2 corner = glm::floor(texels - 0.5F);
        const glm::vec2 t = texels - 0.5F - corner;
        const auto x = static_cast<std::int64_t>(corner.x);
        const auto y = static_cast<std::int64_t>(corner.y);
        return glm::mix(glm::mix(texel<kLinear>(level, x, y), texel<kLinear>(level, x + 1, y), t.x),
                        glm::mix(texel<kLinear>(level, x, y + 1), texel<kLinear>(level, x + 1, y + 1), t.x), t.y);
    }
    /// In linear light, between two levels; place: 0 … 1 over the picture.
    glm::vec4 trilinear(float level, const glm::vec2& place) const {
        const auto top = static_cast<float>(pixels_->level_count() - 1);
        const float clamped = std::clamp(level, 0.0F, top);
        const auto low = static_cast<std::size_t>(clamped);
        const float share = clamped - static_cast<float>(low);
        const glm::vec4 fine = bilinear<true>(low, place * size(low));
        return share > 0 ? glm::mix(fine, bilinear<true>(low + 1, place * size(low + 1)), share) : fine;
    }
    glm::vec2 size(std::size_t level) const {
        return {static_cast<float>(pixels_->width(level)), static_cast<float>(pixels_->height(level))};
    }

  private:
    template <bool kLinear>
    glm::vec4 texel(std::size_t level, std::int64_t column, std::int64_t row) const {
        const std::int64_t width = pixels_->width(level);
        const std::int64_t height = pixels_->height(level);
        if (column < 0 || column >= width || row < 0 || row >= height) {
            if (extension_ == TextureExtension::clip) {
                return glm::vec4(0);
            }
            column = wrapped(column, width);
            row = wrapped(row, height);
        }
        return kLinear ? pixels_->linear(level, column, row) : pixels_->stored(level, column, row);
    }
    std::int64_t wrapped(std::int64_t i, std::int64_t size) const {
        if (extension_ == TextureExtension::repeat) {
            const std::int64_t rest = i % size;
            return rest < 0 ? rest + size : rest;
        }
        if (extension_ == TextureExtension::mirror) {
            const std::int64_t rest = i % (2 * size);
            const std::int64_t twice = rest < 0 ? rest + 2 * size : rest;
            return std::min(twice, 2 * size - 1 - twice);
        }
        return std::clamp<std::int64_t>(i, 0, size - 1);
    }

    const TexturePixels* pixels_;
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

glm::vec4 ImageTexture::sample(const glm::vec2& place, const TextureFootprint& footprint) const {
    const Tile* tile = &tiles_.front();
    glm::vec2 inside = place;
    if (tiled_) {
        const glm::vec2 number = glm::floor(inside);
        const auto found = std::find_if(tiles_.begin(), tiles_.end(), [&](const Tile& own) {
            return static_cast<float>(own.u) == number.x && static_cast<float>(own.v) == number.y;
        });
        if (found == tiles_.end()) {
            return kMissing;
        }
        tile = &*found;
        inside -= number;
    }
    const Lookup lookup(*tile->pixels, extension_);
    const TexelEncoding encoding = tile->pixels->encoding();
    const glm::vec2 size = lookup.size(0);
    glm::vec2 texels = inside * size;
    if (!(std::abs(texels.x) < kFarthest && std::abs(texels.y) < kFarthest)) {
        texels = inside = glm::vec2(0);
    }
    glm::vec2 along = footprint.right * size;
    glm::vec2 across = footprint.below * size;
    if (glm::dot(along, along) < glm::dot(across, across)) {
        std::swap(along, across);
    }
    const float longest = glm::length(along);
    if (!(longest > 1)) {
        const glm::vec4 stored = interpolation_ == TextureInterpolation::closest  ? lookup.closest(texels)
                                 : interpolation_ == TextureInterpolation::linear ? lookup.bilinear<false>(0, texels)
                                                                                  : lookup.cubic(texels);
        return finished(stored, encoding);
    }
    // The area of the footprint over its longest side.
    const float width = std::abs(along.x * across.y - along.y * across.x) / longest;
    const float least = std::max({width, longest / kMostProbes, 1.0F});
    const float level = std::isfinite(least) ? std::log2(least) : static_cast<float>(tile->pixels->level_count());
    const int probes = std::isfinite(longest) ? static_cast<int>(std::ceil(longest / least)) : 1;
    const glm::vec2 step = std::isfinite(longest) ? along / size / static_cast<float>(probes) : glm::vec2(0);
    glm::vec4 sum(0);
    for (int i = 0; i < probes; ++i) {
        sum +=
            lookup.trilinear(level, inside + (static_cast<float>(i) + 0.5F - 0.5F * static_cast<float>(probes)) * step);
    }
    sum /= static_cast<float>(probes);
    if (unassociate_ && sum.w > 0) {
        sum = glm::vec4(glm::vec3(sum) / sum.w, sum.w);
    }
    return sum;
}

}  // namespace shlight
