// SPDX-License-Identifier: MIT
#include "render/refinement.h"

#include <algorithm>
#include <cmath>

namespace shlight {
namespace {

/// Relative error of a pixel that is good enough.
constexpr double kGoodEnough = 0.012;
/// Share of a neighbour's variance that a pixel may have without its rays showing it: that of a tenth of its area, in
/// which an edge or a wire of the neighbour goes on between the rays.
constexpr double kNeighbourShare = 0.1;

/// Of a step of one somewhere in the pixel, what is not linear in the place; for steps between pixels, and of alpha.
constexpr double kEdgeVariance = 1.0 / 16;

double mean(const Vec3d& v) {
    return (v.x + v.y + v.z) / 3;
}

Vec3d color(std::span<const float> image, std::size_t pixel) {
    return {image[4 * pixel], image[4 * pixel + 1], image[4 * pixel + 2]};
}

}  // namespace

Refinement::Refinement(int width, int height, std::uint32_t base_samples, int most_level)
    : width_(width),
      height_(height),
      base_samples_(base_samples),
      most_level_(most_level),
      states_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

void Refinement::merge(const Pixel& pixel, int level, const PixelSums& sums, std::span<float> image) {
    const std::size_t i = index(pixel.column, pixel.row);
    State& state = states_[i];
    const double before = samples(state.level);
    const double all = samples(level);
    const Vec3d radiance = before > 0 ? (before * color(image, i) + sums.radiance) / all : sums.radiance / all;
    const double alpha = before > 0 ? (before * image[4 * i + 3] + sums.opacity) / all : sums.opacity / all;
    for (int channel = 0; channel < 3; ++channel) {
        image[4 * i + static_cast<std::size_t>(channel)] = static_cast<float>(radiance[channel]);
    }
    image[4 * i + 3] = static_cast<float>(alpha);
    // The new rays outnumber the old ones.
    state = {Rgb(sums.variance()), level};
}

void Refinement::set_mean(std::span<const float> image) {
    double sum = 0;
    for (std::size_t i = 0; i < states_.size(); ++i) {
        sum += mean(color(image, i));
    }
    const double average = sum / static_cast<double>(states_.size());
    least_square_ = 0.01 * average * average;
}

std::vector<RefinementGroup> Refinement::next_round(std::span<const float> image) const {
    std::vector<RefinementGroup> groups;
    for (int from = 0; from < most_level_; ++from) {
        for (int to = from + 1; to <= most_level_; ++to) {
            groups.push_back({from, to, {}});
        }
    }
    for (int row = 0; row < height_; ++row) {
        for (int column = 0; column < width_; ++column) {
            const int from = states_[index(column, row)].level;
            const int to = wanted_level(column, row, image);
            const auto group = std::find_if(groups.begin(), groups.end(),
                                            [&](const RefinementGroup& g) { return g.from == from && g.to == to; });
            if (group != groups.end()) {
                group->pixels.push_back({column, row});
            }
        }
    }
    std::erase_if(groups, [](const RefinementGroup& group) { return group.pixels.empty(); });
    return groups;
}

int Refinement::sufficient_level(double variance) const {
    int level = 0;
    while (level < most_level_ && variance * std::pow(samples(level), -1.5) > kGoodEnough * kGoodEnough) {
        ++level;
    }
    return level;
}

int Refinement::wanted_level(int column, int row, std::span<const float> image) const {
    const std::size_t i = index(column, row);
    const State& state = states_[i];
    const Vec3d value = color(image, i);
    const Vec3d scale = value * value + least_square_;
    const double alpha = image[4 * i + 3];
    double variance = 4 * kEdgeVariance * alpha * (1 - alpha);
    if (!(least_square_ > 0)) {  // a black picture
        return std::max<int>(sufficient_level(variance), state.level);
    }
    variance = std::max(variance, mean(Vec3d(state.variance) / scale));
    const int own = sufficient_level(variance);
    // What is only supposed is worth one step at a time, and the less likely the more rays have missed it.
    const double supposed = std::pow(samples(state.level), -1.5) * std::pow(16.0, -state.level) * kNeighbourShare *
                            neighbours_variance(column, row, scale, image);
    const int next = std::min(most_level_, state.level + (supposed > kGoodEnough * kGoodEnough ? 1 : 0));
    return std::max({own, next, static_cast<int>(state.level)});
}

double Refinement::neighbours_variance(int column, int row, const Vec3d& scale, std::span<const float> image) const {
    const Vec3d value = color(image, index(column, row));
    double largest = 0;
    for (int y = std::max(row - 1, 0); y <= std::min(row + 1, height_ - 1); ++y) {
        for (int x = std::max(column - 1, 0); x <= std::min(column + 1, width_ - 1); ++x) {
            const std::size_t i = index(x, y);
            const Vec3d difference = color(image, i) - value;
            const Vec3d variance = glm::max(Vec3d(states_[i].variance), kEdgeVariance * difference * difference);
            largest = std::max(largest, mean(variance / scale));
        }
    }
    return largest;
}

}  // namespace shlight
