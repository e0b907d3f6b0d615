// SPDX-License-Identifier: MIT
//
// Points sorted into cells of space, so small that each holds a few.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shlight/types.h"

namespace shlight {

class PointCells {
  public:
    /// The largest cells, cubes of a regular grid, of which as many hold points as there are times per_cell points.
    PointCells(std::span<const Vec3d> points, std::size_t per_cell);

    /// Numbers of the points, those of a cell one after the other and cells along Morton's curve.
    std::span<const std::uint32_t> order() const { return order_; }
    std::size_t size() const { return codes_.size(); }
    /// The cell of order()[i].
    std::uint32_t cell(std::size_t i) const { return cell_[i]; }
    /// Calls visit(number) for a cell and those around it, also across corners, that hold points.
    template <class Visit>
    void for_each_near(std::size_t cell, const Visit& visit) const {
        for (int i = 0; i < 27; ++i) {
            if (const std::size_t near = find(codes_[cell], {i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1}); near < size()) {
                visit(near);
            }
        }
    }

  private:
    /// The number of the cell beside the one with this code, so many steps away; size(): there is none.
    std::size_t find(std::uint64_t code, const glm::ivec3& steps) const;

    std::vector<std::uint32_t> order_, cell_;
    std::vector<std::uint64_t> codes_;  // of each cell, ascending: the bits of its coordinates in turn
};

}  // namespace shlight
