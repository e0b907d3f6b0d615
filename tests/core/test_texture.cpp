// SPDX-License-Identifier: MIT
//
// Look-ups of textures with footprints of any size.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "shaders/image_texture.h"

namespace shlight {
namespace {

std::shared_ptr<const TexturePixels> grey(std::vector<float> pixels, TexelEncoding encoding,
                                          TextureInterpolation interpolation) {
    return std::make_shared<const TexturePixels>(std::move(pixels), 4U, 4U, 1, encoding, interpolation,
                                                 TextureExtension::repeat);
}

/// A picture of one colour shows it whatever the footprint, also where a neighbour has no place in it.
TEST(Texture, OfOneColorIsThatColor) {
    const auto pixels = grey(std::vector<float>(16, 0.25F), TexelEncoding::linear, TextureInterpolation::linear);
    const ImageTexture texture({{0, 0, pixels}}, TextureInterpolation::linear, TextureExtension::repeat, false, false);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const float size : {0.0F, 1.0F, 1e18F, 1e30F, HUGE_VALF, nan}) {
        const glm::vec4 color = texture.sample({0.5F, 0.5F}, {{1, 0}, {size, size}});
        EXPECT_LE(std::abs(color.x - 0.25F), 1e-6F) << size;
    }
}

/// Neither sums of the largest floats nor their decoding leave the range.
TEST(Texture, OfTheLargestFloatsIsFinite) {
    std::vector<float> largest(16, HUGE_VALF);
    std::fill_n(largest.begin(), 8, -HUGE_VALF);
    for (const TexelEncoding encoding : {TexelEncoding::linear, TexelEncoding::srgb}) {
        for (const auto interpolation : {TextureInterpolation::linear, TextureInterpolation::cubic}) {
            const auto pixels = grey(largest, encoding, interpolation);
            const ImageTexture texture({{0, 0, pixels}}, interpolation, TextureExtension::repeat, false, false);
            for (int i = 0; i < 48; ++i) {
                const float size = static_cast<float>(i % 3) * 0.3F;
                const glm::vec2 place = glm::vec2(i / 12, i / 3 % 4) / 3.5F;
                const glm::vec4 color = texture.sample(place, {{size, 0}, {0, size}});
                EXPECT_LE(std::abs(color.x), std::numeric_limits<float>::max()) << i;
            }
        }
    }
}

}  // namespace
}  // namespace shlight
