// SPDX-License-Identifier: MIT
#include "shaders/image_texture.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <limits>
#include <type_traits>
#include <utility>

#include <hwy/cache_control.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "shaders/shown_rows.h"
#include "shaders/srgb.h"

namespace shlight {
namespace {

/// Maximum number of look-ups along the longer side of a footprint; longer footprints are also blurred across.
constexpr float kMostProbes = 24;
/// Texel coordinates beyond this lie further apart than one texel in float.
constexpr float kFarthest = 1e7F;

constexpr glm::vec4 kMissing(1, 0, 1, 1);

/// Smaller shares of a texel are rounding errors.
constexpr float kLeastCover = 1e-6F;

using ByteTable = std::array<float, 256>;

/// The value of each byte.
template <class Function>
ByteTable byte_table(const Function& function) {
    ByteTable values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = function(static_cast<float>(i) / 255);
    }
    return values;
}

const ByteTable& bytes_as_stored() {
    static const ByteTable table = byte_table([](float x) { return x; });
    return table;
}
const ByteTable& bytes_from_srgb() {
    static const ByteTable table = byte_table(linear_from_srgb);
    return table;
}

float finite(float value) {
    return std::isnan(value)
               ? 0.0F
               : std::clamp(value, std::numeric_limits<float>::lowest(), std::numeric_limits<float>::max());
}

constexpr std::uint16_t kSignOfHalf = 0x8000;
constexpr std::uint16_t kLargestHalf = 0x7BFF;  // 65504

Half finite(Half value) {
    const auto magnitude = static_cast<std::uint16_t>(value.bits & ~kSignOfHalf);
    const int first_nan = 0x7C01;
    const auto sign = static_cast<std::uint16_t>(value.bits & kSignOfHalf);
    return magnitude >= first_nan ? Half{0}
                                  : Half{static_cast<std::uint16_t>(sign | std::min(magnitude, kLargestHalf))};
}

template <class Integer>
Integer finite(Integer value) requires std::integral<Integer> {
    return value;
}

// Conversions of stored numbers to float, and of float to the nearest stored number.
float to_float(float value) {
    return value;
}
float to_float(std::uint16_t value) {
    return static_cast<float>(value) / 65535;
}
/// A float's exponent has three bits more than a half's; the product corrects the bias, also of subnormal numbers.
float to_float(Half value) {
    const std::uint32_t magnitude = value.bits & static_cast<std::uint32_t>(~kSignOfHalf & 0xFFFF);
    const float scaled = std::bit_cast<float>(magnitude << 13U) * 0x1p112F;
    return (value.bits & kSignOfHalf) != 0 ? -scaled : scaled;
}

void assign(float value, float& to) {
    to = value;
}
template <class Integer>
void assign(float value, Integer& to) requires std::integral<Integer> {
    constexpr auto largest = static_cast<float>(std::numeric_limits<Integer>::max());
    to = static_cast<Integer>(std::lround(std::clamp(value, 0.0F, 1.0F) * largest));
}
void assign(float value, Half& to) {
    // After the product, the upper bits are those of a half; the addition rounds the lower 13 bits to nearest even.
    const auto bits = std::bit_cast<std::uint32_t>(std::min(std::abs(value), 65504.0F) * 0x1p-112F);
    const std::uint32_t rounded = (bits + 0x0FFFU + ((bits >> 13U) & 1U)) >> 13U;
    to.bits = static_cast<std::uint16_t>(rounded | (std::signbit(value) ? std::uint32_t{kSignOfHalf} : 0U));
}

/// Weights of a uniform cubic B-spline.
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

void Texels::prefetch(const glm::vec2& place) const {
    const auto inside = [](float along, std::int64_t size) {
        return static_cast<std::int64_t>((along - std::floor(along)) * static_cast<float>(size - 1));
    };
    const std::int64_t first = (inside(place.y, height) * width + inside(place.x, width)) * channels_;
    const std::int64_t row = width * channels_;
    const auto fetch = [&](const auto* numbers) {
        hwy::Prefetch(numbers + first);
        hwy::Prefetch(numbers + (first >= row ? first - row : first));
    };
    bytes_ != nullptr    ? fetch(bytes_)
    : floats_ != nullptr ? fetch(floats_)
    : halves_ != nullptr ? fetch(halves_)
                         : fetch(shorts_);
}

template <class Number>
glm::vec4 Texels::of_numbers(const Number* texel) const {
    const float first = to_float(texel[0]);
    if (channels_ == 1) {
        return glm::vec4(glm::vec3(from_srgb_ ? linear_from_srgb(first) : first), 1);
    }
    const glm::vec4 color(first, to_float(texel[1]), to_float(texel[2]), channels_ == 4 ? to_float(texel[3]) : 1.0F);
    return from_srgb_ ? decoded(color, TexelEncoding::srgb) : color;
}

TexturePixels::TexturePixels(TexelNumbers pixels, std::uint32_t width, std::uint32_t height, int channels,
                             TexelEncoding encoding, TextureInterpolation interpolation, bool is_filtered)
    : encoding_(encoding) {
    std::visit(
        [](auto& numbers) {
            std::transform(numbers.begin(), numbers.end(), numbers.begin(), [](auto x) { return finite(x); });
        },
        pixels);
    add({width, height, channels, std::move(pixels)});
    while (is_filtered && (levels_.back().width > 1 || levels_.back().height > 1)) {
        add(halved(levels_.size() - 1, interpolation));
    }
}

std::size_t TexturePixels::size_in_bytes() const {
    std::size_t bytes = 0;
    for (const Level& level : levels_) {
        bytes += std::visit([](const auto& numbers) { return numbers.size() * sizeof(numbers[0]); }, level.pixels);
    }
    return bytes;
}

Texels TexturePixels::texels(const Level& level, const ByteTable& bytes) {
    Texels result{};
    result.width = level.width;
    result.height = level.height;
    const auto data_of = [&](const auto* numbers) { return numbers != nullptr ? numbers->data() : nullptr; };
    result.bytes_ = data_of(std::get_if<std::vector<std::uint8_t>>(&level.pixels));
    result.shorts_ = data_of(std::get_if<std::vector<std::uint16_t>>(&level.pixels));
    result.halves_ = data_of(std::get_if<std::vector<Half>>(&level.pixels));
    result.floats_ = data_of(std::get_if<std::vector<float>>(&level.pixels));
    result.table_ = bytes.data();
    result.channels_ = level.channels;
    return result;
}

void TexturePixels::add(Level level) {
    // Moving a level keeps the addresses of its numbers, to which stored_ and linear_ point.
    levels_.push_back(std::move(level));
    stored_.push_back(texels(levels_.back(), bytes_as_stored()));
    const bool srgb = is_srgb(levels_.size() - 1);
    Texels& linear = linear_.emplace_back(texels(levels_.back(), srgb ? bytes_from_srgb() : bytes_as_stored()));
    linear.from_srgb_ = srgb;
}

void TexturePixels::store(Level& level, std::size_t texel, const glm::vec4& linear) const {
    const auto channels = static_cast<std::size_t>(level.channels);
    std::visit(
        [&](auto& numbers) {
            for (std::size_t i = 0; i < channels; ++i) {
                assign(linear[static_cast<int>(i)], numbers[texel * channels + i]);
            }
        },
        level.pixels);
}

/// The next level; each of its texels is the mean over an equal share of the area, also if a side is odd.
TexturePixels::Level TexturePixels::halved(std::size_t level, TextureInterpolation interpolation) const {
    const Level& from = levels_[level];
    Level to = {(from.width + 1) / 2, (from.height + 1) / 2, from.channels, {}};
    const std::size_t count = std::size_t{to.width} * to.height * static_cast<std::size_t>(to.channels);
    if (std::holds_alternative<std::vector<std::uint8_t>>(from.pixels)) {
        to.pixels = std::vector<Half>(count);
    } else {
        std::visit([&](const auto& numbers) { to.pixels = std::decay_t<decltype(numbers)>(count); }, from.pixels);
    }
    // Part i of `parts` covers i size/parts … (i + 1) size/parts, which overlaps at most three texels.
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
    ShownRows shown(stored(level), linear(level), is_srgb(level), interpolation);
    std::vector<glm::vec4> sums(to.width);
    for (std::uint32_t y = 0; y < to.height; ++y) {
        const Cover rows = cover(y, to.height, from.height);
        std::fill(sums.begin(), sums.end(), glm::vec4(0));
        for (std::size_t j = 0; j < 3; ++j) {
            if (rows.weights[j] <= kLeastCover) {
                continue;
            }
            const auto& row =
                shown.row(std::min<std::int64_t>(rows.first + static_cast<std::int64_t>(j), from.height - 1));
            for (std::uint32_t x = 0; x < to.width; ++x) {
                for (std::size_t i = 0; i < 3; ++i) {
                    const std::size_t column = std::min(static_cast<std::size_t>(columns[x].first) + i, row.size() - 1);
                    sums[x] += rows.weights[j] * columns[x].weights[i] * row[column];
                }
            }
        }
        for (std::uint32_t x = 0; x < to.width; ++x) {
            store(to, std::size_t{y} * to.width + x, sums[x]);
        }
    }
    return to;
}

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
        if (column < 0 || column >= texels.width || row < 0 || row >= texels.height) {
            if (extension_ == TextureExtension::clip) {
                return glm::vec4(0);
            }
            column = wrapped(column, texels.width);
            row = wrapped(row, texels.height);
        }
        return texels(column, row);
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
    if (!(std::abs(texels.x) < kFarthest && std::abs(texels.y) < kFarthest)) {
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
    if (longest > 1 && pixels.level_count() > 1) {
        // Width of the footprint: its area ÷ its longest side.
        const float width = std::abs(along.x * across.y - along.y * across.x) / longest;
        const float least = std::max({width, longest / kMostProbes, 1.0F});
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
