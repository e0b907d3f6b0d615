// SPDX-License-Identifier: MIT
//
// Transposes between lanes (a vector holds one number of many lights) and rows (an array holds all numbers of one
// light), in registers, by squares of 128 bits. Included once per instruction set.
#if defined(SHLIGHT_KERNELS_ROWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_ROWS_INL_H_
#undef SHLIGHT_KERNELS_ROWS_INL_H_
#else
#define SHLIGHT_KERNELS_ROWS_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "shlight/types.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// Side of a square of 128-bit blocks: 4 floats, 2 doubles.
template <class D>
inline constexpr std::size_t kSquare = 16 / sizeof(Scalar<D>);

/// Start of each lane's row. Lanes beyond the last light repeat it and write the same numbers to the same place.
template <class T>
using RowPointers = std::array<T*, kLaneCount<Lanes<std::remove_const_t<T>>>>;

/// In: v[j] is column j of all lanes. Out: v[j] holds row j of each 128-bit block; block b is lane b · kSquare + j.
template <class D>
HWY_INLINE void transpose_squares(D d, std::array<V<D>, kSquare<D>>& v) {
    if constexpr (kSquare<D> == 4) {
        const auto even_lower = hn::InterleaveLower(d, v[0], v[2]);
        const auto even_upper = hn::InterleaveUpper(d, v[0], v[2]);
        const auto odd_lower = hn::InterleaveLower(d, v[1], v[3]);
        const auto odd_upper = hn::InterleaveUpper(d, v[1], v[3]);
        v = {hn::InterleaveLower(d, even_lower, odd_lower), hn::InterleaveUpper(d, even_lower, odd_lower),
             hn::InterleaveLower(d, even_upper, odd_upper), hn::InterleaveUpper(d, even_upper, odd_upper)};
    } else {
        v = {hn::InterleaveLower(d, v[0], v[1]), hn::InterleaveUpper(d, v[0], v[1])};
    }
}

/// Loads 128-bit blocks from column `column` of every kSquare-th row into one vector.
template <class D, class T>
HWY_INLINE V<D> load_blocks(D d, const T* const* rows, std::size_t column) {
    if constexpr (hn::MaxLanes(d) > kSquare<D>) {
        const hn::Half<D> half;
        return hn::Combine(d, load_blocks(half, rows + hn::MaxLanes(half), column), load_blocks(half, rows, column));
    } else {
        return hn::LoadU(d, *rows + column);
    }
}

/// 128-bit blocks that lie `step` apart, as one vector.
template <class D, class T>
HWY_INLINE V<D> spread_blocks(D d, const T* first, std::size_t step) {
    if constexpr (hn::MaxLanes(d) > kSquare<D>) {
        const hn::Half<D> half;
        constexpr std::size_t kBlocks = hn::MaxLanes(half) / kSquare<D>;
        return hn::Combine(d, spread_blocks(half, first + kBlocks * step, step), spread_blocks(half, first, step));
    } else {
        return hn::Load(d, first);
    }
}

/// Columns `column` … `column + kSquare - 1` of all lanes' rows, which must be readable up to a whole square.
template <class D, class T>
HWY_INLINE std::array<V<D>, kSquare<D>> load_columns(D d, const T* const* rows, std::size_t column) {
    std::array<V<D>, kSquare<D>> v;
    for (std::size_t j = 0; j < kSquare<D>; ++j) {
        v[j] = load_blocks(d, rows + j, column);
    }
    transpose_squares(d, v);
    return v;
}

/// Stores a vector's 128-bit blocks at column `column` of every kSquare-th row.
template <class D, class T>
HWY_INLINE void store_blocks(D d, V<D> v, T* const* rows, std::size_t column) {
    if constexpr (hn::MaxLanes(d) > kSquare<D>) {
        const hn::Half<D> half;
        store_blocks(half, hn::LowerHalf(half, v), rows, column);
        store_blocks(half, hn::UpperHalf(half, v), rows + hn::MaxLanes(half), column);
    } else {
        hn::StoreU(v, d, *rows + column);
    }
}

/// Writes columns `column` … `column + kSquare - 1` to all lanes' rows.
template <class D, class T>
HWY_INLINE void store_columns(D d, std::array<V<D>, kSquare<D>> columns, T* const* rows, std::size_t column) {
    transpose_squares(d, columns);
    for (std::size_t j = 0; j < kSquare<D>; ++j) {
        store_blocks(d, columns[j], rows + j, column);
    }
}

/// Collects the columns of a matrix as lanes and writes them to rows in whole cache lines.
template <class T>
class RowWriter {
  public:
    /// Output::streamed takes effect only if every row begins on a cache line.
    RowWriter(const RowPointers<T>& rows, std::size_t order, Output output)
        : rows_(rows), streamed_(output == Output::streamed), rows_collide_(order * order * sizeof(T) % kPage == 0) {
        for (const T* row : rows) {
            streamed_ &= reinterpret_cast<std::uintptr_t>(row) % 64 == 0;
        }
    }

    /// Buffer for the next columns, kLaneCount values each, to be filled before any other call. columns: at most 4
    /// kMaxOrder, which is two bands.
    T* take(std::size_t columns) {
        if (waiting_ + columns > kColumns) {
            write_lines();
        }
        waiting_ += columns;
        return column(waiting_ - columns);
    }

    /// Writes the columns that are still in the buffer.
    void finish() {
        write_lines();
        for (std::size_t c = 0; c < waiting_; ++c) {
            for (std::size_t lane = 0; lane < kLaneCount<D>; ++lane) {
                rows_[lane][column_ + c] = column(c)[lane];
            }
        }
        waiting_ = 0;
    }

  private:
    using D = Lanes<T>;
    using RowGroup = std::array<T*, kSquare<D>>;
    static constexpr std::size_t kLine = 64 / sizeof(T);
    static constexpr std::size_t kPage = 4096;
    static constexpr std::size_t kParts = kLine / kLaneCount<D>;             // vectors in a line
    static constexpr std::size_t kLinesAtOnce = 16 / (kParts * kSquare<D>);  // as many as fit into registers
    static constexpr std::size_t kColumns = 4 * kMaxOrder + kLine;           // rows of order 16, or two bands

    T* column(std::size_t c) { return buffer_.data() + c * kLaneCount<D>; }

    /// Writes all complete cache lines, and moves the remaining columns to the front.
    HWY_NOINLINE void write_lines() {
        const std::size_t lines = waiting_ / kLine;
        for (std::size_t lane = 0; lane < kLaneCount<D>; lane += kSquare<D>) {
            if (streamed_ && rows_collide_) {
                stage_lines(lane, lines);
            } else {
                RowGroup rows;
                for (std::size_t j = 0; j < rows.size(); ++j) {
                    rows[j] = rows_[lane + j] + column_;
                }
                transpose_lines(lane, lines, rows, streamed_ ? rows.size() : 0);
            }
        }
        const std::size_t done = lines * kLine;
        column_ += done;
        std::copy(column(done), column(waiting_), buffer_.data());
        waiting_ -= done;
    }

    /// Streams the lines of one row after another: lines of several rows in turn, at the same offset in their pages,
    /// take three times as long. The first row is streamed at once; the others are first copied into the L1 cache.
    void stage_lines(std::size_t lane, std::size_t lines) {
        const D d;
        constexpr std::size_t kPitch = kColumns + kLine;
        alignas(64) std::array<T, (kSquare<D> - 1) * kPitch> staged;
        RowGroup rows;
        rows[0] = rows_[lane] + column_;
        for (std::size_t j = 1; j < rows.size(); ++j) {
            rows[j] = staged.data() + (j - 1) * kPitch;
        }
        transpose_lines(lane, lines, rows, 1);
        for (std::size_t j = 1; j < rows.size(); ++j) {
            T* row = rows_[lane + j] + column_;
            for (std::size_t c = 0; c < lines * kLine; c += kLaneCount<D>) {
                hn::Stream(hn::Load(d, rows[j] + c), d, row + c);
            }
        }
    }

    /// streamed: number of rows, from the first on, that are written around the caches.
    void transpose_lines(std::size_t lane, std::size_t lines, const RowGroup& rows, std::size_t streamed) {
        std::size_t line = 0;
        for (; line + kLinesAtOnce <= lines; line += kLinesAtOnce) {
            transpose_neighbours<kLinesAtOnce>(lane, line * kLine, rows, streamed);
        }
        for (; line < lines; ++line) {
            transpose_neighbours<1>(lane, line * kLine, rows, streamed);
        }
    }

    /// Writes kLines cache lines from column `first` on, of as many adjacent rows as a 128-bit block has lanes. Rows
    /// further apart would collide in the cache at more orders: every fourth row of order 16 does.
    template <std::size_t kLines>
    HWY_INLINE void transpose_neighbours(std::size_t lane, std::size_t first, const RowGroup& rows,
                                         std::size_t streamed) {
        const D d;
        constexpr std::size_t kLanes = kLaneCount<D>;
        std::array<std::array<V<D>, kSquare<D>>, kLines * kParts> squares;
        for (std::size_t part = 0; part < squares.size(); ++part) {
            const T* from = column(first + part * kLanes) + lane;
            for (std::size_t j = 0; j < kSquare<D>; ++j) {
                squares[part][j] = spread_blocks(d, from + j * kLanes, kSquare<D> * kLanes);
            }
            transpose_squares(d, squares[part]);
        }
        for (std::size_t j = 0; j < kSquare<D>; ++j) {
            T* row = rows[j] + first;
            for (std::size_t part = 0; part < squares.size(); ++part) {
                if (j < streamed) {
                    hn::Stream(squares[part][j], d, row + part * kLanes);
                } else {
                    hn::StoreU(squares[part][j], d, row + part * kLanes);
                }
            }
        }
    }

    RowPointers<T> rows_;
    bool streamed_;
    bool rows_collide_;
    std::size_t waiting_ = 0;
    std::size_t column_ = 0;
    alignas(64) std::array<T, kColumns * kLaneCount<D>> buffer_;
};

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
