// SPDX-License-Identifier: MIT
//
// Arcs of the outlines of many regions, each a row of its own: what lanes of polygons write and lanes of arcs read.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "gauss_legendre.h"

namespace shlight {

/// An arc of the circle {u : u·axis = cosine}, |τ| ≤ half from its middle:
///   u(τ) = cosine · axis + sine · (middle cosτ + axis × middle sinτ),   the interior on its left, u·axis > cosine.
/// Four numbers a square, which is what rows are read by.
template <class R>
struct ArcRow {
    std::array<R, 3> axis;    ///< unit
    R half;                   ///< half its angle about the axis, > 0
    std::array<R, 3> middle;  ///< unit, across the axis
    R cosine, sine;           ///< 0 and 1 for a great circle
    std::array<R, 3> unused;

    const R* data() const { return axis.data(); }
    R* data() { return axis.data(); }
};

/// An arc of the horizon, run through counter-clockwise about z from one azimuth to another.
template <class R>
struct HorizonRow {
    R from_cosine, from_sine, to_cosine, to_sine;  ///< of the azimuths
    R angle;                                       ///< between them, which may be more than half a turn
    std::array<R, 3> unused;

    const R* data() const { return &from_cosine; }
};

/// A list that grows without writing what is overwritten anyway.
template <class Row>
class RowList {
  public:
    std::size_t size() const { return size_; }
    void clear() { size_ = 0; }
    const Row& operator[](std::size_t i) const { return rows_[i]; }
    Row& operator[](std::size_t i) { return rows_[i]; }
    /// Room for so many more.
    void reserve(std::size_t more) {
        if (rows_.size() < size_ + more) {
            rows_.resize(2 * (size_ + more));
        }
    }
    /// Precondition: there is room.
    Row& add() { return rows_[size_++]; }

  private:
    std::vector<Row> rows_;
    std::size_t size_ = 0;
};

/// Arcs with the region that each belongs to and the number of Gauss points that it takes.
template <class R>
struct ArcList {
    RowList<ArcRow<R>> arcs;
    RowList<std::uint32_t> region_of_arc;
    RowList<std::uint8_t> points;  ///< 1 … kMaxGaussPoints
    RowList<HorizonRow<R>> horizon;
    RowList<std::uint32_t> region_of_horizon;

    void clear() {
        arcs.clear();
        region_of_arc.clear();
        points.clear();
        horizon.clear();
        region_of_horizon.clear();
    }
};

/// Indices of a list's arcs by number of points, those of equal number in their order.
class ArcOrder {
  public:
    explicit ArcOrder(const RowList<std::uint8_t>& points);
    /// The arcs of so many points.
    const std::uint32_t* begin(int points) const { return index_.data() + start_[static_cast<std::size_t>(points)]; }
    std::size_t count(int points) const {
        return start_[static_cast<std::size_t>(points) + 1] - start_[static_cast<std::size_t>(points)];
    }

  private:
    std::vector<std::uint32_t> index_;
    std::array<std::uint32_t, kMaxGaussPoints + 2> start_{};
};

/// Gauss points to integrate waves of κ radians to either side of the middle: by Bernstein's inequality k points err by
///   E_k = 2^{2k+1} k!⁴ κ^{2k} / ((2k+1) (2k)!³),     E_{k+1} = E_k κ² growth[k],
/// times the largest value and half the length.
inline constexpr auto kGaussErrorGrowth = [] {
    std::array<double, kMaxGaussPoints> growth{};
    for (int k = 0; k < kMaxGaussPoints; ++k) {
        growth[static_cast<std::size_t>(k)] = (k + 1) / (2.0 * (2 * k + 1) * (2 * k + 1) * (2 * k + 3));
    }
    return growth;
}();

/// How an arc is cut: `pieces` of equal length with `points` each.
struct Division {
    int pieces, points;
};
Division divided(double kappa, double tolerance);

}  // namespace shlight
