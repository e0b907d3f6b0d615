// SPDX-License-Identifier: MIT
//
// Arcs of the boundaries of many regions, each a row of its own: what lanes of polygons write and lanes of arcs read.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "math/gauss_legendre.h"

namespace shlight {

/// An arc of the circle {u : u·axis = cosine}, |τ| ≤ half from its middle:
///   u(τ) = cosine · axis + sine · (middle cosτ + axis × middle sinτ),   the interior on its left, u·axis > cosine.
/// 0 … 2 the axis, 3 half of the angle about it, 4 … 6 the middle, a unit vector across the axis, 7 the number of the
/// region that it belongs to, 8 cosine, 9 sine (not there for great circles); rows are read four numbers at a time.
template <class R>
using ArcRow = std::array<R, 12>;

/// An arc of the horizon, run through counter-clockwise about z: 0, 1 cosine and sine of the azimuth where it begins,
/// 2, 3 of that where it ends, 4 the angle between them, which may be more than half a turn, 7 the region.
template <class R>
using HorizonRow = std::array<R, 8>;

/// Rows in blocks that never move. Many short lists share one store, so that an empty one costs nothing.
template <class Row>
class RowStore {
  public:
    static constexpr std::size_t kBlock = 16;  ///< a multiple of any number of lanes

    /// Takes all blocks back.
    void clear() { used_ = 0; }
    /// A block that nobody else has, of any content.
    Row* block() {
        const std::size_t slab = used_ / kSlab;
        if (slab == slabs_.size()) {
            slabs_.push_back(std::make_unique_for_overwrite<Slab>());
        }
        return slabs_[slab]->data() + used_++ % kSlab * kBlock;
    }

  private:
    static constexpr std::size_t kSlab = 32;
    using Slab = std::array<Row, kSlab * kBlock>;

    std::vector<std::unique_ptr<Slab>> slabs_;
    std::size_t used_ = 0;
};

template <class Row>
class RowList {
  public:
    void clear() {
        blocks_.clear();
        next_ = end_ = nullptr;
    }
    std::size_t size() const { return blocks_.size() * RowStore<Row>::kBlock - static_cast<std::size_t>(end_ - next_); }
    const Row& operator[](std::size_t i) const { return blocks_[i / RowStore<Row>::kBlock][i % RowStore<Row>::kBlock]; }
    /// Row `first` and those that follow, at least up to the next multiple of kBlock: beyond size() of any content.
    const Row* from(std::size_t first) const { return &(*this)[first]; }
    std::size_t region(std::size_t i) const { return static_cast<std::size_t>((*this)[i][7]); }
    Row& add(RowStore<Row>& store) {
        if (next_ == end_) {
            blocks_.push_back(store.block());
            next_ = blocks_.back();
            end_ = next_ + RowStore<Row>::kBlock;
        }
        return *next_++;
    }

  private:
    Row* next_ = nullptr;
    Row* end_ = nullptr;
    std::vector<Row*> blocks_;
};

/// Arcs of many regions, sorted by the number of Gauss points that they take, and arcs of the horizon.
template <class R>
class ArcLists {
  public:
    const RowList<ArcRow<R>>& arcs(std::size_t points) const { return arcs_[points]; }
    const RowList<HorizonRow<R>>& horizon() const { return horizon_; }
    ArcRow<R>& add_arc(std::size_t points) { return arcs_[points].add(arc_store_); }
    HorizonRow<R>& add_horizon() { return horizon_.add(horizon_store_); }

    void clear() {
        for (auto& rows : arcs_) {
            rows.clear();
        }
        horizon_.clear();
        arc_store_.clear();
        horizon_store_.clear();
    }

  private:
    std::array<RowList<ArcRow<R>>, kMaxGaussPoints + 1> arcs_;
    RowList<HorizonRow<R>> horizon_;
    RowStore<ArcRow<R>> arc_store_;
    RowStore<HorizonRow<R>> horizon_store_;
};

/// Gauss points to integrate waves of κ radians to either side of the middle: by Bernstein's inequality k points err by
///   E_k = 2^{2k+1} k!⁴ κ^{2k} / ((2k+1) (2k)!³),     E_{k+1} = E_k κ² growth[k],
/// times the largest value and half the length.
using GaussErrorGrowth = std::array<double, kMaxGaussPoints>;
inline constexpr GaussErrorGrowth kGaussErrorGrowth = [] {
    GaussErrorGrowth growth{};
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
