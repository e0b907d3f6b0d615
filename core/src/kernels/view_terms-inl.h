// SPDX-License-Identifier: MIT
//
// The cosine terms of a lobe at the view of each lane, interpolated from its table. Included once per instruction set.
#if defined(SHLIGHT_KERNELS_VIEW_TERMS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_VIEW_TERMS_INL_H_
#undef SHLIGHT_KERNELS_VIEW_TERMS_INL_H_
#else
#define SHLIGHT_KERNELS_VIEW_TERMS_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "kernels/lanes-inl.h"
#include "kernels/rows-inl.h"
#include "kernels/tabulated_lobe.h"
#include "kernels/views-inl.h"
#include "warped_row.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// The weighted sum of four numbers.
HWY_INLINE V<Floats> cubic(const std::array<V<Floats>, 4>& weights, V<Floats> a, V<Floats> b, V<Floats> c,
                           V<Floats> e) {
    const auto sum = hn::MulAdd(weights[1], b, hn::Mul(weights[0], a));
    return hn::MulAdd(weights[3], e, hn::MulAdd(weights[2], c, sum));
}

#if HWY_TARGET <= HWY_AVX3

/// 32 neighbouring rows of one column of a table, in registers: each lane picks its own.
class ColumnWindow {
  public:
    static constexpr int kRows = 32;

    HWY_INLINE explicit ColumnWindow(const float* from)
        : low_(hn::LoadU(Floats(), from)), high_(hn::LoadU(Floats(), from + kLaneCount<Floats>)) {}
    /// Only the lowest five bits of `row` count.
    HWY_INLINE V<Floats> operator[](V<hn::RebindToSigned<Floats>> row) const {
        return V<Floats>{_mm512_permutex2var_ps(low_.raw, row.raw, high_.raw)};
    }

  private:
    V<Floats> low_, high_;
};
static_assert(kLaneCount<Floats> == 16 && kWarpedViews + 1 <= 2 * ColumnWindow::kRows &&
              kViewColumn >= 2 * ColumnWindow::kRows);

/// `count` terms, a vector for each; up to the next multiple of kSquare<Floats> may be written.
HWY_INLINE void write_terms(const TabulatedLobe& table, const ViewLanes& view, std::size_t count, float* out) {
    const Floats d;
    const hn::RebindToSigned<Floats> di;
    const auto& w = view.weights;
    const auto last = hn::Add(view.row, hn::Set(di, 3));
    const std::int32_t least = hn::GetLane(hn::MinOfLanes(di, view.row));
    const std::int32_t most = hn::GetLane(hn::MaxOfLanes(di, last));
    if (most - least < ColumnWindow::kRows) {
        const std::int32_t first = std::min(least, ColumnWindow::kRows);
        const auto row0 = hn::Sub(view.row, hn::Set(di, first));
        const auto row1 = hn::Add(row0, hn::Set(di, 1));
        const auto row2 = hn::Add(row0, hn::Set(di, 2));
        const auto row3 = hn::Add(row0, hn::Set(di, 3));
        const float* column = table.columns + first;
        for (std::size_t k = 0; k < count; ++k, column += kViewColumn) {
            const ColumnWindow window(column);
            hn::Store(cubic(w, window[row0], window[row1], window[row2], window[row3]), d,
                      out + k * kLaneCount<Floats>);
        }
        return;
    }
    // All rows are in two windows of a whole number of vectors.
    const auto row1 = hn::Add(view.row, hn::Set(di, 1));
    const auto row2 = hn::Add(view.row, hn::Set(di, 2));
    const auto end = hn::Set(di, ColumnWindow::kRows);
    const std::array<M<Floats>, 4> is_low = {hn::RebindMask(d, hn::Lt(view.row, end)),
                                             hn::RebindMask(d, hn::Lt(row1, end)), hn::RebindMask(d, hn::Lt(row2, end)),
                                             hn::RebindMask(d, hn::Lt(last, end))};
    const float* column = table.columns;
    for (std::size_t k = 0; k < count; ++k, column += kViewColumn) {
        const ColumnWindow low(column);
        const ColumnWindow high(column + ColumnWindow::kRows);
        const auto pick = [&](std::size_t j, V<hn::RebindToSigned<Floats>> row)
                              HWY_ATTR { return hn::IfThenElse(is_low[j], low[row], high[row]); };
        hn::Store(cubic(w, pick(0, view.row), pick(1, row1), pick(2, row2), pick(3, last)), d,
                  out + k * kLaneCount<Floats>);
    }
}

#else

/// `count` terms, a vector for each; up to the next multiple of kSquare<Floats> may be written.
HWY_INLINE void write_terms(const TabulatedLobe& table, const ViewLanes& view, std::size_t count, float* out) {
    const Floats d;
    constexpr std::size_t kLanes = kLaneCount<Floats>;
    constexpr std::size_t kBlock = kSquare<Floats>;
    // A square of terms and lanes at a time: interpolated along rows, then turned.
    constexpr std::size_t kTile = std::max(kLanes, kBlock);
    alignas(64) std::array<std::int32_t, kLanes> first;
    alignas(64) std::array<std::array<float, kLanes>, 4> weights;
    hn::Store(view.row, hn::RebindToSigned<Floats>(), first.data());
    for (std::size_t j = 0; j < weights.size(); ++j) {
        hn::Store(view.weights[j], d, weights[j].data());
    }
    alignas(64) std::array<std::array<float, kTile>, kLanes> tile;
    std::array<const float*, kLanes> rows;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        rows[lane] = tile[lane].data();
    }
    for (std::size_t k = 0; k < count; k += kTile) {
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const float* from = table.rows + static_cast<std::size_t>(first[lane]) * table.width + k;
            const std::array<V<Floats>, 4> w = {hn::Set(d, weights[0][lane]), hn::Set(d, weights[1][lane]),
                                                hn::Set(d, weights[2][lane]), hn::Set(d, weights[3][lane])};
            for (std::size_t i = 0; i < kTile; i += kLanes) {
                const auto row = [&](std::size_t j) HWY_ATTR { return hn::Load(d, from + j * table.width + i); };
                hn::Store(cubic(w, row(0), row(1), row(2), row(3)), d, tile[lane].data() + i);
            }
        }
        for (std::size_t i = 0; i < kTile && k + i < count; i += kBlock) {
            const auto columns = load_columns(d, rows.data(), i);
            for (std::size_t j = 0; j < kBlock; ++j) {
                hn::Store(columns[j], d, out + (k + i + j) * kLanes);
            }
        }
    }
}

#endif

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
