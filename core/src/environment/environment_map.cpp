// SPDX-License-Identifier: MIT
#include "environment/environment_map.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <functional>
#include <numbers>
#include <queue>
#include <utility>

#include <tbb/parallel_for.h>

namespace shlight {
namespace {

using std::numbers::pi;

/// What is brighter than this times the mean counts as a spot: within the width of band 63, some 0.003 sr, it would
/// hold a hundredth of the picture's light.
constexpr double kSpotLimit = 30;
/// This many spots take no more time than the harmonics do.
constexpr std::size_t kMostSpots = 512;

std::size_t texel_index(int column, int row, int width) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
}

double texel_solid_angle(std::size_t row, int width, int height) {
    const double step = pi / height;
    // cosθ at the edges, by a product.
    return 2 * pi / width * 2 * std::sin((static_cast<double>(row) + 0.5) * step) * std::sin(step / 2);
}

double luminance_of(const Rgb& radiance) {
    return glm::dot(kLuminance, Vec3d(radiance));
}

Rgb bilinear(const LatLong& picture, const glm::dvec2& texel) {
    const glm::dvec2 place = texel - 0.5;
    const double left = std::floor(place.x);
    const double y = std::clamp(place.y, 0.0, picture.height - 1.0);
    const int above = std::min(static_cast<int>(y), std::max(picture.height - 2, 0));
    const int below = std::min(above + 1, picture.height - 1);
    const auto first = static_cast<int>(left);
    const std::array columns = {(first + picture.width) % picture.width, (first + 1) % picture.width};
    const auto s = static_cast<float>(place.x - left);
    const auto t = static_cast<float>(y - above);
    const auto row = [&](int r) {
        return (1 - s) * picture.pixels[texel_index(columns[0], r, picture.width)] +
               s * picture.pixels[texel_index(columns[1], r, picture.width)];
    };
    return (1 - t) * row(above) + t * row(below);
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

Rgb radiance_from(const LatLong& picture, const Vec3d& direction) {
    return bilinear(picture, texel_of(direction, picture.width, picture.height));
}

RadiancePyramid::RadiancePyramid(int width, int height, const Row& finest, const Stopped& stopped) {
    assert(width > 1 || height > 1);
    Level fine = {width, height, 0};
    std::size_t size = 0;
    while (fine.width > 1 || fine.height > 1) {
        fine = {(fine.width + 1) / 2, (fine.height + 1) / 2, static_cast<int>(size)};
        levels_.push_back(fine);
        size += static_cast<std::size_t>(fine.width) * static_cast<std::size_t>(fine.height);
    }
    pixels_.resize(size);
    fine = {width, height, 0};
    for (const Level& coarse : levels_) {
        tbb::parallel_for(0, coarse.height, [&](int row) {
            end_if(stopped);
            // The last of an odd number of rows or columns counts twice.
            const std::array rows = {2 * row, std::min(2 * row + 1, fine.height - 1)};
            const auto columns = static_cast<std::size_t>(fine.width);
            std::array<std::vector<Rgb>, 2> texels;
            for (std::size_t i = 0; i < 2; ++i) {
                texels[i].resize(columns);
                if (&coarse == &levels_.front()) {
                    finest(rows[i], texels[i]);
                } else {
                    const auto first = pixels_.begin() + fine.first + std::ptrdiff_t{rows[i]} * fine.width;
                    std::copy_n(first, columns, texels[i].begin());
                }
            }
            const double upper = std::sin((rows[0] + 0.5) / fine.height * pi);
            const double lower = std::sin((rows[1] + 0.5) / fine.height * pi);
            const auto share = static_cast<float>(lower / (upper + lower));
            Rgb* out = pixels_.data() + coarse.first + static_cast<std::ptrdiff_t>(row) * coarse.width;
            for (std::size_t left = 0; left < columns; left += 2) {
                const std::size_t right = std::min(left + 1, columns - 1);
                *out++ = (1 - share) * 0.5F * (texels[0][left] + texels[0][right]) +
                         share * 0.5F * (texels[1][left] + texels[1][right]);
            }
        });
        fine = coarse;
    }
}

RadianceSampler::RadianceSampler(const LatLong& picture, const Stopped& stopped)
    : width_(picture.width), height_(picture.height) {
    const int width = width_;
    const int height = height_;
    // Rows of cells begin at a pole, at the centres of rows of texels, and end at the other pole.
    latitudes_.push_back(1);
    for (int row = 0; row < height; ++row) {
        latitudes_.push_back(std::cos((row + 0.5) / height * pi));
    }
    latitudes_.push_back(-1);
    const auto luminance = [&](int column, int row) {
        return luminance_of(picture.pixels[texel_index(column % width, std::clamp(row, 0, height - 1), width)]);
    };
    cells_.reserve(picture.pixels.size() + static_cast<std::size_t>(width));
    double all = 0;
    for (int row = 0; row <= height; ++row) {
        end_if(stopped);
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
    assert(all > 0);
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

glm::ivec2 RadianceSampler::cell_of(const Vec3d& direction) const {
    const glm::dvec2 place = texel_of(direction, width_, height_);
    return {(static_cast<int>(std::floor(place.x - 0.5)) + width_) % width_,
            std::clamp(static_cast<int>(std::floor(place.y + 0.5)), 0, height_)};
}

double RadianceSampler::density(const Vec3d& direction) const {
    const glm::ivec2 found = cell_of(direction);
    const int column = found.x;
    const int row = found.y;
    const double in_cell = cells_[cell(column, row)] - (column > 0 ? cells_[cell(column - 1, row)] : 0.0F);
    return double{row_densities_[static_cast<std::size_t>(row)]} * in_cell;
}

BrightTexels::BrightTexels(const LatLong& picture) {
    const auto width = static_cast<std::size_t>(picture.width);
    const auto solid_angle = [&](std::size_t i) { return texel_solid_angle(i / width, picture.width, picture.height); };
    // The luminances of the brightest texels, one more than there may be spots.
    std::priority_queue<double, std::vector<double>, std::greater<>> brightest;
    double mean = 0;
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        const double luminance = luminance_of(picture.pixels[i]);
        mean += luminance * solid_angle(i) / (4 * pi);
        if (brightest.size() <= kMostSpots || luminance > brightest.top()) {
            brightest.push(luminance);
        }
        if (brightest.size() > kMostSpots + 1) {
            brightest.pop();
        }
    }
    limit = kSpotLimit * mean;
    if (brightest.size() > kMostSpots) {
        limit = std::max(limit, brightest.top());
    }
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        if (luminance_of(picture.pixels[i]) > limit) {
            spots.push_back({direction_of(glm::dvec2(i % width, i / width) + 0.5, picture.width, picture.height),
                             (picture.pixels[i] - below(picture.pixels[i])) * static_cast<float>(solid_angle(i))});
        }
    }
}

Rgb BrightTexels::below(const Rgb& texel) const {
    const double luminance = luminance_of(texel);
    return luminance > limit ? texel * static_cast<float>(limit / luminance) : texel;
}

namespace {

RadiancePyramid pyramid_of(const LatLong& picture, const BrightTexels* without, const Stopped& stopped) {
    const auto row_of = [&](int row, std::span<Rgb> texels) {
        const auto* own = &picture.pixels[static_cast<std::size_t>(row) * texels.size()];
        std::transform(own, own + texels.size(), texels.begin(),
                       [&](const Rgb& texel) { return without != nullptr ? without->below(texel) : texel; });
    };
    return {picture.width, picture.height, row_of, stopped};
}

}  // namespace

EnvironmentMap::EnvironmentMap(std::shared_ptr<const LatLong> source, const Stopped& stopped)
    : picture(std::move(source)),
      bright(*picture),
      sampler(*picture, stopped),
      coefficients(radiance_coefficients(*picture, bright, stopped)),
      smooth(pyramid_of(*picture, &bright, stopped)),
      whole(pyramid_of(*picture, nullptr, stopped)) {}

}  // namespace shlight
