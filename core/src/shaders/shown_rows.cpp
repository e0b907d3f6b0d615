// SPDX-License-Identifier: MIT
#include "shaders/shown_rows.h"

#include <algorithm>
#include <utility>

#include "shaders/srgb.h"

namespace shlight {
namespace {

/// Weights of the texels that are interpolated: the first one's number, and of it and those behind it.
struct Taps {
    std::int64_t first;
    int count;
    std::array<float, 4> weights;
};

/// At the middle of texel 0, or halfway to texel 1.
Taps taps_at(TextureInterpolation interpolation, bool halfway) {
    if (interpolation == TextureInterpolation::linear) {
        return halfway ? Taps{0, 2, {0.5F, 0.5F}} : Taps{0, 1, {1}};
    }
    return halfway ? Taps{-1, 4, {1.0F / 48, 23.0F / 48, 23.0F / 48, 1.0F / 48}}
                   : Taps{-1, 3, {1.0F / 6, 4.0F / 6, 1.0F / 6}};
}

/// The sum over taps of what value(number of a texel) gives.
template <class Value>
glm::vec3 sum(const Taps& taps, std::int64_t texel, const Value& value) {
    glm::vec3 result = taps.weights[0] * value(texel + taps.first);
    for (int i = 1; i < taps.count; ++i) {
        result += taps.weights[static_cast<std::size_t>(i)] * value(texel + taps.first + i);
    }
    return result;
}

}  // namespace

const std::vector<glm::vec4>& ShownRows::row(std::int64_t y) {
    if (y == y_) {
        return values_;
    }
    y_ = y;
    values_.resize(static_cast<std::size_t>(linear_->width));
    for (std::size_t x = 0; x < values_.size(); ++x) {
        values_[x] = (*linear_)(static_cast<std::int64_t>(x), y);
    }
    if (!by_cells_) {
        return values_;
    }
    if (y == 0) {
        above_ = line(0, false);
        cells_[1] = means(-1, line(-1, false), above_);
    }
    const Colors own = std::exchange(above_, line(y + 1, false));
    cells_[0] = std::exchange(cells_[1], means(y, own, above_));
    for (std::size_t x = 0; x < values_.size(); ++x) {
        const glm::vec3 sum = cells_[0][x] + cells_[0][x + 1] + cells_[1][x] + cells_[1][x + 1];
        values_[x] = glm::vec4(sum / 4.0F, values_[x].w);
    }
    return values_;
}

ShownRows::Colors ShownRows::line(std::int64_t y, bool halfway) const {
    constexpr std::int64_t kMargin = 2;
    const Taps across = taps_at(interpolation_, halfway);
    Colors columns(static_cast<std::size_t>(stored_->width + 2 * kMargin + 1));
    for (std::size_t c = 0; c < columns.size(); ++c) {
        const std::int64_t x = static_cast<std::int64_t>(c) - kMargin;
        columns[c] = sum(across, y, [&](std::int64_t row) { return glm::vec3(stored_->at(x, row, extension_)); });
    }
    const auto column = [&](std::int64_t x) { return columns[static_cast<std::size_t>(x + kMargin)]; };
    const Taps middle = taps_at(interpolation_, false);
    const Taps edge = taps_at(interpolation_, true);
    Colors line;
    line.reserve(2 * columns.size());
    for (std::int64_t x = -1; x <= stored_->width; ++x) {
        line.push_back(linear_from_srgb_near(sum(middle, x, column)));
        line.push_back(linear_from_srgb_near(sum(edge, x, column)));
    }
    return line;
}

/// Simpson's rule in both directions.
ShownRows::Colors ShownRows::means(std::int64_t y, const Colors& below, const Colors& above) const {
    const Colors middle = line(y, true);
    Colors means(static_cast<std::size_t>(stored_->width) + 1);
    for (std::size_t cell = 0; cell < means.size(); ++cell) {
        const std::size_t i = 2 * cell;
        const glm::vec3 corners = below[i] + below[i + 2] + above[i] + above[i + 2];
        const glm::vec3 edges = below[i + 1] + above[i + 1] + middle[i] + middle[i + 2];
        means[cell] = (corners + 4.0F * edges + 16.0F * middle[i + 1]) / 36.0F;
    }
    return means;
}

}  // namespace shlight
