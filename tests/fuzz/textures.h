// SPDX-License-Identifier: MIT
//
// Pictures of random numbers.
#pragma once

#include <memory>
#include <vector>

#include "input.h"
#include "shaders/image_texture.h"

namespace shlight::fuzzing {

template <class Number>
std::vector<Number> draw_numbers(Input& input, std::size_t count) {
    std::vector<Number> numbers(count);
    for (Number& number : numbers) {
        if constexpr (std::is_same_v<Number, float>) {
            number = input.chance() ? static_cast<float>(input.uniform(0, 1)) : input.number<float>();
        } else if constexpr (std::is_same_v<Number, std::uint8_t>) {
            number = static_cast<std::uint8_t>(input.integer(0, 255));
        } else {
            number = Number{static_cast<std::uint16_t>(input.integer(0, 65535))};
        }
    }
    return numbers;
}

inline TexelNumbers draw_texels(Input& input, std::size_t count) {
    switch (input.integer(0, 3)) {
        case 0:
            return draw_numbers<std::uint8_t>(input, count);
        case 1:
            return draw_numbers<std::uint16_t>(input, count);
        case 2:
            return draw_numbers<Half>(input, count);
        default:
            return draw_numbers<float>(input, count);
    }
}

/// unassociate: as ImageTexture takes it.
inline ImageTexture draw_texture(Input& input, bool unassociate) {
    const auto interpolation = static_cast<TextureInterpolation>(input.integer(0, 2));
    const auto extension = static_cast<TextureExtension>(input.integer(0, 3));
    std::vector<ImageTexture::Tile> tiles(input.count(1, input.rarely() ? 3 : 1));
    for (ImageTexture::Tile& tile : tiles) {
        const std::size_t width = input.count(1, input.rarely() ? 33 : 5), height = input.count(1, 5);
        const int channels = input.one_of(std::array{1, 3, 4});
        tile = {static_cast<std::int64_t>(&tile - tiles.data()), input.rarely(),
                std::make_shared<const TexturePixels>(
                    draw_texels(input, width * height * static_cast<std::size_t>(channels)),
                    static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), channels,
                    input.chance() ? TexelEncoding::linear : TexelEncoding::srgb, interpolation, extension)};
    }
    const bool tiled = tiles.size() > 1 || input.rarely();
    return {std::move(tiles), interpolation, extension, unassociate, tiled};
}

}  // namespace shlight::fuzzing
