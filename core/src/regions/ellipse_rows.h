// SPDX-License-Identifier: MIT
//
// Coefficients of boundaries of ellipses in lanes, one piece of a boundary a lane.
#pragma once

#include <array>
#include <cstddef>

#include "regions/arc_rows.h"

namespace shlight {

/// A piece of the boundary of a cone (spherical_ellipse.h), |t| ≤ 1 from its middle:
/// 0 … 2 the long axis, 3 k', 4 … 6 the short axis, 7 the number of the region that it belongs to, 8 … 10 the axis, 11
/// the middle and 12 half of the piece in π u / 2K, 13 half of it in u, 14, 15 sine and cosine of the long half angle,
/// 16, 17 of the short one.
template <class R>
using ConeRow = std::array<R, 20>;

/// How the points lie on a piece.
enum class Spacing { gauss, equal };

/// Pieces of many boundaries, sorted by the points that they take: at Gauss's nodes, or at the middles of equal parts,
/// as many as there are points, for closed boundaries.
template <class R>
class ConeLists {
  public:
    const RowList<ConeRow<R>>& rows(Spacing spacing, std::size_t points) const {
        return rows_[static_cast<std::size_t>(spacing)][points];
    }
    ConeRow<R>& add(Spacing spacing, std::size_t points) {
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
    std::array<std::array<RowList<ConeRow<R>>, kMaxGaussPoints + 1>, 2> rows_;
    RowStore<ConeRow<R>> store_;
};

/// Adds what pieces of boundaries have of all bands to order² numbers for each region, row by row. Of band 0 it is the
/// solid angle between the piece and the cone's axis.
void add_cone_coefficients(const ConeLists<float>& lists, int order, float* coefficients);
void add_cone_coefficients(const ConeLists<double>& lists, int order, double* coefficients);

}  // namespace shlight
