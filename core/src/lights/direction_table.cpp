// SPDX-License-Identifier: MIT
#include "shlight/direction_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/checks.h"

namespace shlight {
namespace {

using std::numbers::pi;

constexpr std::size_t kBlock = 8;     // texels along a side
constexpr double kWideCap = 0.8;      // [rad]; wider ones are taken for all directions
constexpr double kLeastScale = 1e-3;  // [rad]
constexpr double kChange = 0.5;       // part of the largest number

/// The range is that of no numbers.
constexpr ProfileRange kNothing = {std::numeric_limits<double>::infinity(), 0};

void add(ProfileRange& range, double low, double high) {
    range = {std::min(range.low, low), std::max(range.high, high)};
}

}  // namespace

DirectionTable::DirectionTable(std::vector<float> values, std::size_t width)
    : values_(std::move(values)),
      width_(width),
      height_(values_.size() / std::max<std::size_t>(width, 1)),
      blocks_along_((width + kBlock - 1) / kBlock),
      all_(kNothing) {
    blocks_.assign(blocks_along_ * ((height_ + kBlock - 1) / kBlock), kNothing);
    for (std::size_t i = 0; i < values_.size(); ++i) {
        const double value{values_[i]};
        if (!(value >= 0 && std::isfinite(value))) {
            reject("profile must be finite and not negative");
        }
        add(blocks_[i / width_ / kBlock * blocks_along_ + i % width_ / kBlock], value, value);
        add(all_, value, value);
    }
    if (!(all_.high > 0)) {
        reject("profile must be above 0 somewhere");
    }
}

DirectionTable::Place DirectionTable::place(const Vec3d& direction) const {
    const double down = std::atan2(std::hypot(direction.x, direction.y), direction.z) / pi;
    const double along = 0.5 - std::atan2(direction.y, direction.x) / (2 * pi);
    return {down * static_cast<double>(height_) - 0.5, along * static_cast<double>(width_) - 0.5};
}

double DirectionTable::texel(std::ptrdiff_t row, std::ptrdiff_t column) const {
    const auto width = static_cast<std::ptrdiff_t>(width_);
    const std::ptrdiff_t own = std::clamp<std::ptrdiff_t>(row, 0, static_cast<std::ptrdiff_t>(height_) - 1);
    return double{values_[static_cast<std::size_t>(own * width + (column + width) % width)]};
}

double DirectionTable::at(const Vec3d& direction) const {
    const Place place = this->place(direction);
    const double row = std::floor(place.row);
    const double column = std::floor(place.column);
    const auto i = static_cast<std::ptrdiff_t>(row);
    const auto j = static_cast<std::ptrdiff_t>(column);
    return std::lerp(std::lerp(texel(i, j), texel(i, j + 1), place.column - column),
                     std::lerp(texel(i + 1, j), texel(i + 1, j + 1), place.column - column), place.row - row);
}

ProfileRange DirectionTable::range(const Vec3d& direction, double half_angle) const {
    if (half_angle > kWideCap) {
        return all_;
    }
    const Place middle = place(direction);
    const double texel_angle = pi / static_cast<double>(height_);
    const double angle = (middle.row + 0.5) * texel_angle;
    // Half the cap's extent along a circle of latitude; around a pole it is all of it.
    const bool has_pole = !(angle > half_angle && pi - angle > half_angle);
    const double turn = has_pole ? pi : std::asin(std::min(1.0, std::sin(half_angle) / std::sin(angle)));
    const double rows = half_angle / texel_angle + 1;
    const double columns = turn / (2 * pi) * static_cast<double>(width_) + 1;
    const auto block = [](double texel) { return static_cast<std::ptrdiff_t>(std::floor(texel / double{kBlock})); };
    const auto block_rows = static_cast<std::ptrdiff_t>(blocks_.size() / blocks_along_);
    const auto along = static_cast<std::ptrdiff_t>(blocks_along_);
    // One block more on both sides: beyond the seam they begin anew, where the last one may be narrower.
    const std::ptrdiff_t first = block(middle.column - columns) - 1;
    const std::ptrdiff_t last = block(middle.column + columns) + 1;
    const bool around_all = has_pole || last - first >= along;
    const std::ptrdiff_t left = around_all ? 0 : first;
    const std::ptrdiff_t right = around_all ? along - 1 : last;
    ProfileRange found = kNothing;
    for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(block(middle.row - rows), 0);
         i <= std::min(block(middle.row + rows), block_rows - 1); ++i) {
        for (std::ptrdiff_t j = left; j <= right; ++j) {
            const ProfileRange& own = blocks_[static_cast<std::size_t>(i * along + (j + along) % along)];
            add(found, own.low, own.high);
        }
    }
    return found;
}

double DirectionTable::scale(const Vec3d& direction) const {
    double angle = 1;
    while (angle > kLeastScale) {
        const ProfileRange around = range(direction, angle);
        if (around.high - around.low < kChange * all_.high) {
            break;
        }
        angle /= 2;
    }
    return angle;
}

}  // namespace shlight
