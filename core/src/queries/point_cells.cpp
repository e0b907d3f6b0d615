// SPDX-License-Identifier: MIT
#include "queries/point_cells.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "base/ray_rounding.h"
#include "shlight/mesh.h"

namespace shlight {
namespace {

constexpr int kBits = 21;  // of a coordinate: three of them fill a code

/// Every third bit of the result is one of these.
std::uint64_t spread_bits(std::uint64_t bits) {
    constexpr std::array<std::pair<int, std::uint64_t>, 5> kSteps = {{{32, 0x1F00000000FFFFULL},
                                                                      {16, 0x1F0000FF0000FFULL},
                                                                      {8, 0x100F00F00F00F00FULL},
                                                                      {4, 0x10C30C30C30C30C3ULL},
                                                                      {2, 0x1249249249249249ULL}}};
    for (const auto& [shift, mask] : kSteps) {
        bits = (bits | bits << shift) & mask;
    }
    return bits;
}

constexpr std::uint64_t kEveryThird = 0x1249249249249249ULL;

/// A coordinate, spread, one more or less; beyond the first or last one there is none, and the result is not spread.
std::uint64_t stepped(std::uint64_t spread, int step) {
    if (step == 0) {
        return spread;
    }
    // The bits between are set for carries to pass, and clear for borrows.
    return step > 0 ? ((spread | ~kEveryThird) + 1) & kEveryThird : (spread - 1) & kEveryThird;
}

}  // namespace

PointCells::PointCells(std::span<const Vec3d> points, std::size_t per_cell) {
    Box box;
    for (const Vec3d& point : points) {
        box.add(point);
    }
    const double extent = std::max(largest_component(box.largest - box.least), std::numeric_limits<double>::min());
    std::vector<std::pair<std::uint64_t, std::uint32_t>> keys;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const Vec3d place = (points[i] - box.least) / extent * double{(1 << kBits) - 1};
        std::uint64_t code = 0;
        for (int axis = 0; axis < 3; ++axis) {
            code |= spread_bits(static_cast<std::uint64_t>(place[axis])) << axis;
        }
        keys.emplace_back(code, i);
    }
    std::sort(keys.begin(), keys.end());
    for (int shift = 3 * kBits; shift >= 0 && codes_.size() * per_cell < points.size(); shift -= 3) {
        codes_.clear();
        cell_.clear();
        for (const auto& [code, point] : keys) {
            if (const std::uint64_t own = shift < 64 ? code >> shift : 0; codes_.empty() || codes_.back() != own) {
                codes_.push_back(own);
            }
            cell_.push_back(static_cast<std::uint32_t>(codes_.size() - 1));
        }
    }
    std::transform(keys.begin(), keys.end(), std::back_inserter(order_), [](const auto& key) { return key.second; });
}

std::size_t PointCells::find(std::uint64_t code, const glm::ivec3& steps) const {
    std::uint64_t wanted = 0;
    for (int axis = 0; axis < 3; ++axis) {
        wanted |= stepped(code >> axis & kEveryThird, steps[axis]) << axis;
    }
    const auto found = std::lower_bound(codes_.begin(), codes_.end(), wanted);
    return found != codes_.end() && *found == wanted ? static_cast<std::size_t>(found - codes_.begin()) : size();
}

}  // namespace shlight
