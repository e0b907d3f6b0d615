// SPDX-License-Identifier: MIT
#include "environment/environment_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <utility>

namespace shlight {
namespace {

using std::numbers::pi;

constexpr Vec3d kLuminance(0.2126, 0.7152, 0.0722);

/// What is brighter than this times the mean counts as a spot: within the width of band 63, some 0.003 sr, it would
/// hold a hundredth of the picture's light.
constexpr double kSpotLimit = 30;
/// As many as take no more time than the harmonics do.
constexpr std::size_t kMostSpots = 512;

std::size_t texel_index(int column, int row, int width) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
}

double texel_solid_angle(std::size_t row, int width, int height) {
    const double step = pi / height;
    // cosθ at the edges, by a product.
    return 2 * pi / width * 2 * std::sin((static_cast<double>(row) + 0.5) * step) * std::sin(step / 2);
}

}  // namespace

glm::dvec2 texel_of(const Vec3d& direction, int width, int height) {
    const double longitude = std::atan2(direction.y, direction.x);
    const double latitude = std::atan2(direction.z, std::hypot(direction.x, direction.y));
    return {(0.5 - longitude / (2 * pi)) * width, (0.5 - latitude / pi) * height};
}

Vec3d direction_of(const glm::dvec2& texel, int width, int height) {
    const double longitude = (1 - 2 * texel.x / width) * pi;
    const double tilt = texel.y / height * pi;
    return {std::sin(tilt) * std::cos(longitude), std::sin(tilt) * std::sin(longitude), std::cos(tilt)};
}

RadiancePyramid::RadiancePyramid(std::vector<Rgb> pixels, int width, int height, Levels wanted)
    : levels_{{width, height, 0}}, pixels_(std::move(pixels)) {
    while (wanted == Levels::all && (levels_.back().width > 1 || levels_.back().height > 1)) {
        const Level fine = levels_.back();
        const Level coarse = {(fine.width + 1) / 2, (fine.height + 1) / 2, static_cast<int>(pixels_.size())};
        for (int row = 0; row < coarse.height; ++row) {
            for (int column = 0; column < coarse.width; ++column) {
                // Of an odd number of rows or columns the last counts twice.
                const int right = std::min(2 * column + 1, fine.width - 1);
                const int below = std::min(2 * row + 1, fine.height - 1);
                const auto at = [&](int c, int r) {
                    return pixels_[static_cast<std::size_t>(fine.first) + texel_index(c, r, fine.width)];
                };
                const double upper = std::sin((2 * row + 0.5) / fine.height * pi);
                const double lower = std::sin((below + 0.5) / fine.height * pi);
                const auto share = static_cast<float>(lower / (upper + lower));
                pixels_.push_back((1 - share) * 0.5F * (at(2 * column, 2 * row) + at(right, 2 * row)) +
                                  share * 0.5F * (at(2 * column, below) + at(right, below)));
            }
        }
        levels_.push_back(coarse);
    }
}

Rgb RadiancePyramid::radiance(const Vec3d& direction) const {
    const glm::dvec2 place = texel_of(direction, width(), height()) - 0.5;
    const double left = std::floor(place.x);
    const double y = std::clamp(place.y, 0.0, height() - 1.0);
    const int above = std::min(static_cast<int>(y), std::max(height() - 2, 0));
    const int below = std::min(above + 1, height() - 1);
    const auto first = static_cast<int>(left);
    const std::array columns = {(first + width()) % width(), (first + 1) % width()};
    const auto s = static_cast<float>(place.x - left);
    const auto t = static_cast<float>(y - above);
    const auto row = [&](int r) {
        return (1 - s) * pixels_[texel_index(columns[0], r, width())] +
               s * pixels_[texel_index(columns[1], r, width())];
    };
    return (1 - t) * row(above) + t * row(below);
}

RadianceSampler::RadianceSampler(std::span<const Rgb> pixels, int width, int height) : width_(width), height_(height) {
    // Rows of cells begin at a pole, at the centres of rows of texels, and end at the other pole.
    latitudes_.push_back(1);
    for (int row = 0; row < height; ++row) {
        latitudes_.push_back(std::cos((row + 0.5) / height * pi));
    }
    latitudes_.push_back(-1);
    const auto luminance = [&](int column, int row) {
        return glm::dot(kLuminance, Vec3d(pixels[texel_index(column % width, std::clamp(row, 0, height - 1), width)]));
    };
    double all = 0;
    for (int row = 0; row <= height; ++row) {
        double sum = 0;
        std::vector<double> shares;
        for (int column = 0; column < width; ++column) {
            for (const int c : {column, column + 1}) {
                sum += luminance(c, row - 1) + luminance(c, row);
            }
            shares.push_back(sum);
        }
        for (const double share : shares) {
            cells_.push_back(static_cast<float>(sum > 0 ? share / sum : 1));
        }
        cells_.back() = 1;
        const auto i = static_cast<std::size_t>(row);
        all += sum * (latitudes_[i] - latitudes_[i + 1]);
        rows_.push_back(all);
    }
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        rows_[i] /= all;
        const double solid_angle = (latitudes_[i] - latitudes_[i + 1]) * 2 * pi / width;  // of a cell
        row_densities_.push_back(static_cast<float>((rows_[i] - (i > 0 ? rows_[i - 1] : 0.0)) / solid_angle));
    }
}

Vec3d RadianceSampler::sample(const glm::dvec2& point) const {
    const auto row = static_cast<std::size_t>(std::min(
        std::upper_bound(rows_.begin(), rows_.end(), point.y) - rows_.begin(), static_cast<std::ptrdiff_t>(height_)));
    const double above = row > 0 ? rows_[row - 1] : 0.0;
    const double down = std::clamp((point.y - above) / (rows_[row] - above), 0.0, 1.0);
    const auto first = cells_.begin() + static_cast<std::ptrdiff_t>(cell(0, static_cast<int>(row)));
    const auto x = static_cast<float>(point.x);
    const auto column = std::min<std::ptrdiff_t>(std::upper_bound(first, first + width_, x) - first, width_ - 1);
    const float left = column > 0 ? first[column - 1] : 0.0F;
    const float across = std::clamp((x - left) / (first[column] - left), 0.0F, 1.0F);
    const double longitude = (1 - 2 * (static_cast<double>(column) + 0.5 + across) / width_) * pi;
    const double z = latitudes_[row] + down * (latitudes_[row + 1] - latitudes_[row]);
    const double sine = std::sqrt(std::max(0.0, (1 - z) * (1 + z)));
    return {sine * std::cos(longitude), sine * std::sin(longitude), z};
}

double RadianceSampler::density(const Vec3d& direction) const {
    const glm::dvec2 place = texel_of(direction, width_, height_);
    const int row = std::clamp(static_cast<int>(std::floor(place.y + 0.5)), 0, height_);
    const int column = (static_cast<int>(std::floor(place.x - 0.5)) + width_) % width_;
    const double in_cell = cells_[cell(column, row)] - (column > 0 ? cells_[cell(column - 1, row)] : 0.0F);
    return double{row_densities_[static_cast<std::size_t>(row)]} * in_cell;
}

SplitPicture without_spots(std::span<const Rgb> pixels, int width, int height) {
    std::vector<double> luminance;
    double mean = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        luminance.push_back(glm::dot(kLuminance, Vec3d(pixels[i])));
        mean += luminance.back() * texel_solid_angle(i / static_cast<std::size_t>(width), width, height) / (4 * pi);
    }
    double limit = kSpotLimit * mean;
    std::vector<double> brightest = luminance;
    if (brightest.size() > kMostSpots) {
        const auto last = brightest.begin() + static_cast<std::ptrdiff_t>(kMostSpots);
        std::nth_element(brightest.begin(), last, brightest.end(), std::greater<>());
        limit = std::max(limit, *last);
    }
    SplitPicture split = {{pixels.begin(), pixels.end()}, {}};
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        if (luminance[i] > limit) {
            const std::size_t row = i / static_cast<std::size_t>(width);
            const std::size_t column = i % static_cast<std::size_t>(width);
            split.pixels[i] *= static_cast<float>(limit / luminance[i]);
            split.spots.push_back(
                {direction_of(glm::dvec2(column, row) + 0.5, width, height),
                 (pixels[i] - split.pixels[i]) * static_cast<float>(texel_solid_angle(row, width, height))});
        }
    }
    return split;
}

EnvironmentMap::EnvironmentMap(const LatLong& source)
    : EnvironmentMap(source, without_spots(source.pixels, source.width, source.height)) {}

EnvironmentMap::EnvironmentMap(const LatLong& source, SplitPicture split)
    : to_world(source.to_world),
      texel(pi / source.height),
      picture(source.pixels, source.width, source.height, RadiancePyramid::Levels::first),
      sampler(source.pixels, source.width, source.height),
      spots(std::move(split.spots)),
      smooth(split.pixels, source.width, source.height, RadiancePyramid::Levels::first),
      coefficients(radiance_coefficients(split.pixels, source.width, source.height)),
      remainder(remainder_of(split.pixels, source.width, source.height, coefficients), source.width, source.height),
      whole_remainder(remainder_of(source.pixels, source.width, source.height, coefficients), source.width,
                      source.height) {}

}  // namespace shlight
