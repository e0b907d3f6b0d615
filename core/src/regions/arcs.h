// SPDX-License-Identifier: MIT
//
// Arcs of the boundaries of many regions, one row of numbers each: what lanes of polygons write and lanes of arcs read.
// Rows are read four numbers at a time.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <type_traits>
#include <vector>

#include "math/gauss_legendre.h"
#include "shlight/types.h"

namespace shlight {

/// An arc of the circle that bounds the cap (axis; cosine), |τ| ≤ half from its middle:
///   u(τ) = cosine · axis + sine · (middle cosτ + axis × middle sinτ),   the region on its left, u·axis > cosine.
template <class R>
struct Arc {
    Vec3<R> axis;
    R half;          ///< half of the angle about the axis
    Vec3<R> middle;  ///< a unit vector across the axis
    R region;        ///< number of the region that the arc belongs to
    R cosine, sine;  ///< read of boosted arcs only: the others are of great circles
    std::array<R, 2> unused;
};

/// An arc of the horizon, run through counter-clockwise about z.
template <class R>
struct HorizonArc {
    R from_cosine, from_sine;  ///< azimuth of its beginning
    R to_cosine, to_sine;      ///< azimuth of its end
    R angle;                   ///< between them, which may be more than half a turn
    std::array<R, 2> unused;
    R region;
};

/// A piece of the boundary of an elliptic cone (spherical_ellipse.h), |t| ≤ 1 from its middle.
template <class R>
struct ConeArc {
    Vec3<R> long_axis;
    R complement;  ///< k'
    Vec3<R> short_axis;
    R region;
    Vec3<R> axis;
    R middle, half_turn;     ///< the middle and half of the piece in π u / 2K
    R half;                  ///< half of the piece in u
    R sin_long, cos_long;    ///< the long half angle
    R sin_short, cos_short;  ///< the short half angle
    std::array<R, 2> unused;
};

/// The numbers of an arc in their order.
template <class Row>
auto* numbers(Row& row) {
    using R = decltype(row.region);
    return reinterpret_cast<std::conditional_t<std::is_const_v<Row>, const R, R>*>(&row);
}
template <class Row>
inline constexpr std::size_t kNumbers = sizeof(Row) / sizeof(Row::region);

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
    std::size_t region(std::size_t i) const { return static_cast<std::size_t>((*this)[i].region); }
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

/// How points lie on an arc: at Gauss's nodes, or at the middles of equal parts, for closed boundaries.
enum class Spacing { gauss, equal };

/// Arcs of one kind, Arc or ConeArc, of many regions, sorted by the number of points that they take.
template <class Row>
class SortedArcs {
  public:
    const RowList<Row>& rows(std::size_t points, Spacing spacing = Spacing::gauss) const {
        return rows_[static_cast<std::size_t>(spacing)][points];
    }
    Row& add(std::size_t points, Spacing spacing = Spacing::gauss) {
        return rows_[static_cast<std::size_t>(spacing)][points].add(store_);
    }
    void clear() {
        for (auto& lists : rows_) {
            for (auto& rows : lists) {
                rows.clear();
            }
        }
        store_.clear();
    }

  private:
    std::array<std::array<RowList<Row>, kMaxGaussPoints + 1>, 2> rows_;
    RowStore<Row> store_;
};

/// Arcs of many regions, and the arcs of the horizon that close them.
template <class R, class Row = Arc<R>>
struct ArcLists {
    SortedArcs<Row> arcs;
    RowList<HorizonArc<R>> horizon;
    RowStore<HorizonArc<R>> horizon_store;

    HorizonArc<R>& add_horizon() { return horizon.add(horizon_store); }
    void clear() {
        arcs.clear();
        horizon.clear();
        horizon_store.clear();
    }
};

/// Adds what the boundaries of elliptic cones have of all bands to order² numbers for each region, row by row. Of
/// band 0 a piece of the boundary has the solid angle between it and the cone's axis. Bands 0 and 1 of arcs of the
/// horizon are left out.
void add_cone_coefficients(const ArcLists<float, ConeArc<float>>& lists, int order, float* coefficients);
void add_cone_coefficients(const ArcLists<double, ConeArc<double>>& lists, int order, double* coefficients);

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
