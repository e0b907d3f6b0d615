// SPDX-License-Identifier: MIT
#include "shaders/image_texture.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/common.hpp>

namespace shlight {

ImageTexture::ImageTexture(std::vector<glm::vec4> pixels, std::uint32_t width, std::uint32_t height,
                           TextureInterpolation interpolation, TextureExtension extension)
    : pixels_(std::move(pixels)),
      width_(width),
      height_(height),
      interpolation_(interpolation),
      extension_(extension) {}

glm::vec4 ImageTexture::texel(std::int64_t column, std::int64_t row) const {
    const auto wrapped = [&](std::int64_t i, std::int64_t size) {
        switch (extension_) {
            case TextureExtension::repeat:
                return (i % size + size) % size;
            case TextureExtension::mirror: {
                const std::int64_t j = (i % (2 * size) + 2 * size) % (2 * size);
                return std::min(j, 2 * size - 1 - j);
            }
            default:
                return std::clamp<std::int64_t>(i, 0, size - 1);
        }
    };
    const auto w = static_cast<std::int64_t>(width_);
    const auto h = static_cast<std::int64_t>(height_);
    if (extension_ == TextureExtension::clip && (column < 0 || column >= w || row < 0 || row >= h)) {
        return glm::vec4(0);
    }
    return pixels_[static_cast<std::size_t>(wrapped(row, h) * w + wrapped(column, w))];
}

glm::vec4 ImageTexture::sample(const glm::vec2& place, const TextureFootprint& /*footprint*/) const {
    const float x = place.x * static_cast<float>(width_);
    const float y = place.y * static_cast<float>(height_);
    // Far outside, and where a coordinate is no number, all texels are alike.
    if (!(std::abs(x) < 1e15F && std::abs(y) < 1e15F)) {
        return texel(0, 0);
    }
    if (interpolation_ == TextureInterpolation::closest) {
        return texel(static_cast<std::int64_t>(std::floor(x)), static_cast<std::int64_t>(std::floor(y)));
    }
    const float left = std::floor(x - 0.5F);
    const float below = std::floor(y - 0.5F);
    const auto column = static_cast<std::int64_t>(left);
    const auto row = static_cast<std::int64_t>(below);
    const float s = x - 0.5F - left;
    return glm::mix(glm::mix(texel(column, row), texel(column + 1, row), s),
                    glm::mix(texel(column, row + 1), texel(column + 1, row + 1), s), y - 0.5F - below);
}

}  // namespace shlight
