// SPDX-License-Identifier: MIT
#include "environment/sky_blocks.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "environment/environment_map.h"

namespace shlight {
namespace {

using std::numbers::pi;

/// sums: up to each element, it included.
template <class Sums>
double before(const Sums& sums, std::size_t index) {
    return index > 0 ? double{sums[index - 1]} : 0.0;
}

/// Blocks of as many elements, of which each has a place in 0 … 1. first: where each block begins.
template <std::size_t count, class Place>
std::vector<std::uint8_t> blocks(std::size_t size, const Place& place, std::array<std::size_t, count>& first) {
    std::vector<std::uint8_t> of;
    for (std::size_t i = 0; i < size; ++i) {
        of.push_back(static_cast<std::uint8_t>(std::min(place(i) * (count - 1), count - 2.0)));
        std::fill(first.begin() + of.back() + 1, first.end(), i + 1);
    }
    return of;
}

}  // namespace

SkyBlocks::SkyBlocks(const Environment& environment) : map_(environment.map()) {
    if (map_ != nullptr) {
        divide(map_->sampler);
    } else {
        light_.fill(1.0F / kBlocks);
    }
}

void SkyBlocks::divide(const RadianceSampler& sampler) {
    const auto width = static_cast<std::size_t>(sampler.width());
    const auto last = static_cast<std::size_t>(sampler.height());
    const auto part = [](std::size_t i, std::size_t of) { return static_cast<double>(i) / static_cast<double>(of); };
    column_of_ = blocks(
        width, [&](std::size_t column) { return part(column, width); }, first_column_);
    row_of_ = blocks(
        last + 1, [&](std::size_t row) { return (1 - std::cos(part(row, last) * pi)) / 2; }, first_row_);
    for (std::size_t column = 0; column < kBlockColumns; ++column) {
        double sum = 0;
        for (std::size_t row = 0; row <= last; ++row) {
            const double share = sampler.rows()[row] - before(sampler.rows(), row);
            const float* cells = sampler.cells() + row * width;
            const double light =
                share * (before(cells, first_column_[column + 1]) - before(cells, first_column_[column]));
            light_[row_of_[row] * kBlockColumns + column] += static_cast<float>(light);
            sum += light;
            up_to_row_[column].push_back(sum);
        }
    }
}

std::size_t SkyBlocks::block_of(const Vec3d& direction) const {
    const Vec3d own = map_ != nullptr ? map_->to_map(direction) : direction;
    if (map_ == nullptr) {
        const double azimuth = std::atan2(own.y, own.x) / (2 * pi) + 0.5;
        const double row = std::clamp((1 - own.z) / 2 * kBlockRows, 0.0, kBlockRows - 1.0);
        return static_cast<std::size_t>(row) * kBlockColumns +
               std::min(static_cast<std::size_t>(azimuth * kBlockColumns), kBlockColumns - 1);
    }
    const glm::ivec2 cell = map_->sampler.cell_of(own);
    return row_of_[static_cast<std::size_t>(cell.y)] * kBlockColumns + column_of_[static_cast<std::size_t>(cell.x)];
}

Vec3d SkyBlocks::sample(std::size_t block, double u, double v) const {
    const std::size_t column = block % kBlockColumns;
    const std::size_t block_row = block / kBlockColumns;
    if (map_ == nullptr) {
        const double z = 1 - 2 * (static_cast<double>(block_row) + v) / kBlockRows;
        const double azimuth = 2 * pi * ((static_cast<double>(column) + u) / kBlockColumns - 0.5);
        const double sine = std::sqrt(std::max(1 - z * z, 0.0));
        return {sine * std::cos(azimuth), sine * std::sin(azimuth), z};
    }
    const std::vector<double>& rows = up_to_row_[column];
    const std::size_t first = first_row_[block_row];
    const std::size_t end = first_row_[block_row + 1];
    const double at = glm::mix(before(rows, first), rows[end - 1], v);
    const auto begin = rows.begin();
    const auto found =
        std::upper_bound(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(end) - 1, at);
    const auto row = static_cast<std::size_t>(found - begin);
    const double share = rows[row] - before(rows, row);
    const double down = share > 0 ? std::clamp((at - before(rows, row)) / share, 0.0, 1.0) : 0.5;
    const RadianceSampler& sampler = map_->sampler;
    const float* cells = sampler.cells() + row * static_cast<std::size_t>(sampler.width());
    return map_->picture->to_world *
           sampler.sample({glm::mix(before(cells, first_column_[column]), before(cells, first_column_[column + 1]), u),
                           glm::mix(before(sampler.rows(), row), sampler.rows()[row], down)});
}

}  // namespace shlight
