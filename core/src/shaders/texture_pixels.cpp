// SPDX-License-Identifier: MIT
#include "shaders/texture_pixels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <limits>
#include <type_traits>
#include <utility>

#include <hwy/cache_control.h>

#include "base/scene_range.h"
#include "shaders/shown_rows.h"
#include "shaders/srgb.h"

namespace shlight {
namespace {

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

/// Sums of numbers within the range of radiance, and what sRGB makes of them, stay finite.
float finite(float value) {
    return std::isnan(value) ? 0.0F : std::clamp(value, -kBrightest, kBrightest);
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

/// The number within a picture of this size that stands for any number of a texel.
std::int64_t continued(std::int64_t i, std::int64_t size, TextureExtension extension) {
    if (extension == TextureExtension::repeat) {
        const std::int64_t rest = i % size;
        return rest < 0 ? rest + size : rest;
    }
    if (extension == TextureExtension::mirror) {
        const std::int64_t rest = i % (2 * size);
        const std::int64_t twice = rest < 0 ? rest + 2 * size : rest;
        return std::min(twice, 2 * size - 1 - twice);
    }
    return std::clamp<std::int64_t>(i, 0, size - 1);
}

}  // namespace

glm::vec4 decoded(const glm::vec4& stored, TexelEncoding encoding) {
    return encoding != TexelEncoding::srgb ? stored
                                           : glm::vec4(linear_from_srgb(stored.x), linear_from_srgb(stored.y),
                                                       linear_from_srgb(stored.z), stored.w);
}

glm::vec4 Texels::beyond(std::int64_t column, std::int64_t row, TextureExtension extension) const {
    return extension == TextureExtension::clip
               ? glm::vec4(0)
               : (*this)(continued(column, width, extension), continued(row, height, extension));
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

// Other sources read texels through the header.
template glm::vec4 Texels::of_numbers(const float*) const;
template glm::vec4 Texels::of_numbers(const Half*) const;
template glm::vec4 Texels::of_numbers(const std::uint16_t*) const;

TexturePixels::TexturePixels(TexelNumbers pixels, std::uint32_t width, std::uint32_t height, int channels,
                             TexelEncoding encoding, TextureInterpolation interpolation, TextureExtension extension)
    : encoding_(encoding) {
    std::visit(
        [](auto& numbers) {
            std::transform(numbers.begin(), numbers.end(), numbers.begin(), [](auto x) { return finite(x); });
        },
        pixels);
    add({width, height, channels, std::move(pixels)});
    while (levels_.back().width > 1 || levels_.back().height > 1) {
        add(halved(levels_.size() - 1, interpolation, extension));
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
TexturePixels::Level TexturePixels::halved(std::size_t level, TextureInterpolation interpolation,
                                           TextureExtension extension) const {
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
    ShownRows shown(stored(level), linear(level), is_srgb(level), interpolation, extension);
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

}  // namespace shlight
