// SPDX-License-Identifier: MIT
#include "shaders/srgb.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace shlight {

float linear_from_srgb(float encoded) {
    return encoded <= 0.04045F ? std::max(encoded, 0.0F) / 12.92F : std::pow((encoded + 0.055F) / 1.055F, 2.4F);
}

glm::vec3 linear_from_srgb_near(const glm::vec3& encoded) {
    constexpr int kSteps = 4 * 255;
    static const auto table = [] {
        std::array<float, kSteps + 1> values{};
        for (std::size_t i = 0; i < values.size(); ++i) {
            values[i] = linear_from_srgb(static_cast<float>(i) / kSteps);
        }
        return values;
    }();
    const auto near = [&](float x) {
        // Positive numbers round to nearest so; std::lround is slower.
        return table[static_cast<std::size_t>(std::clamp(x, 0.0F, 1.0F) * kSteps + 0.5F)];  // NOLINT
    };
    return {near(encoded.x), near(encoded.y), near(encoded.z)};
}

}  // namespace shlight
