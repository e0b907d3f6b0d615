// SPDX-License-Identifier: MIT
//
// Between lanes (a vector holds one number of many lights) and rows (an array holds all numbers of one light):
// transposes in registers, in squares of 128 bits. Included once per instruction set.
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

#include "kernels/lanes-inl.h"
#include "shlight/types.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// Side of a square of 128-bit blocks: 4 floats, 2 doubles.
template <class D>
inline constexpr std::size_t kSquare = 16 / sizeof(Scalar<D>);

/// Where each lane's row begins. Lanes beyond the last light repeat it: they write the same numbers to the same place.
template <class T>
using RowPointers = std::array<T*, kLaneCount<Lanes<T>>>;

/// Half of transpose_squares: rows 0 … kSquare/2 - 1 of each block's lanes, or for kUpper the others.
template <bool kUpper, class D>
HWY_INLINE std::array<V<D>, kSquare<D> / 2> transpose_half(D d, const std::array<V<D>, kSquare<D>>& v) {
    if constexpr (kSquare<D> == 4) {
        const auto even = kUpper ? hn::InterleaveUpper(d, v[0], v[2]) : hn::InterleaveLower(d, v[0], v[2]);
        const auto odd = kUpper ? hn::InterleaveUpper(d, v[1], v[3]) : hn::InterleaveLower(d, v[1], v[3]);
        return {hn::InterleaveLower(d, even, odd), hn::InterleaveUpper(d, even, odd)};
    } else {
        return {kUpper ? hn::InterleaveUpper(d, v[0], v[1]) : hn::InterleaveLower(d, v[0], v[1])};
    }
}

/// v[j]: column j of all lanes → row j of each block's lanes. Block b of the result's v[j] is lane b · kSquare + j.
template <class D>
HWY_INLINE void transpose_squares(D d, std::array<V<D>, kSquare<D>>& v) {
    const auto lower = transpose_half<false>(d, v);
    const auto upper = transpose_half<true>(d, v);
    std::copy(lower.begin(), lower.end(), v.begin());
    std::copy(upper.begin(), upper.end(), v.begin() + kSquare<D> / 2);
}

/// Block b of q[0] … q[3] → q[b], for vectors of four blocks; for vectors of two, blocks 0 and 1 of the pairs.
template <class D>
HWY_INLINE void transpose_blocks(D d, std::array<V<D>, 4>& q) {
    if constexpr (hn::MaxLanes(d) == 4 * kSquare<D>) {
        const auto even01 = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(q[1]), q[0]);
        const auto even23 = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(q[3]), q[2]);
        const auto odd01 = hn::OddEvenBlocks(q[1], hn::SwapAdjacentBlocks(q[0]));
        const auto odd23 = hn::OddEvenBlocks(q[3], hn::SwapAdjacentBlocks(q[2]));
        q = {hn::ConcatLowerLower(d, even23, even01), hn::ConcatLowerLower(d, odd23, odd01),
             hn::ConcatUpperUpper(d, even23, even01), hn::ConcatUpperUpper(d, odd23, odd01)};
    } else if constexpr (hn::MaxLanes(d) == 2 * kSquare<D>) {
        q = {hn::ConcatLowerLower(d, q[1], q[0]), hn::ConcatLowerLower(d, q[3], q[2]),
             hn::ConcatUpperUpper(d, q[1], q[0]), hn::ConcatUpperUpper(d, q[3], q[2])};
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

/// Columns `column` … `column + kSquare - 1` of all lanes' rows. Reads whole squares: rows must be readable that far.
template <class D, class T>
HWY_INLINE std::array<V<D>, kSquare<D>> load_columns(D d, const T* const* rows, std::size_t column) {
    std::array<V<D>, kSquare<D>> v;
    for (std::size_t j = 0; j < kSquare<D>; ++j) {
        v[j] = load_blocks(d, rows + j, column);
    }
    transpose_squares(d, v);
    return v;
}

/// Collects the columns of a matrix as lanes and writes them to rows, a whole cache line of each row at a time.
template <class T>
class RowWriter {
  public:
    /// Lines are streamed only if all rows begin at one.
    RowWriter(const RowPointers<T>& rows, Output output) : rows_(rows), streamed_(output == Output::streamed) {
        for (const T* row : rows) {
            streamed_ &= reinterpret_cast<std::uintptr_t>(row) % 64 == 0;
        }
    }

    /// Where the next columns go, column after column of kLaneCount values each, at most 2 kMaxOrder - 1 of them.
    T* next() { return buffer_.data() + waiting_ * kLaneCount<D>; }

    /// So many columns were put there.
    void add(std::size_t columns) {
        waiting_ += columns;
        if (waiting_ + 2 * kMaxOrder > kColumns) {
            write_lines();
        }
    }

    /// Writes what waits.
    void finish() {
        write_lines();
        for (std::size_t c = 0; c < waiting_; ++c) {
            for (std::size_t lane = 0; lane < kLaneCount<D>; ++lane) {
                rows_[lane][column_ + c] = buffer_[c * kLaneCount<D> + lane];
            }
        }
        waiting_ = 0;
    }

  private:
    using D = Lanes<T>;
    static constexpr std::size_t kLine = 64 / sizeof(T);
    static constexpr std::size_t kColumns = 4 * kMaxOrder;  // rows of order 16, or 16 KiB

    /// Writes whole lines, and moves the rest to the front.
    ///
    /// Half the rows at a time, and two neighbouring lines of each: rows of order 32 or 64 lie a multiple of 4 KiB
    /// apart, and stores to the same line of all of them in turn compete for one set of the cache
    /// (docs/performance.md).
    void write_lines() {
        const std::size_t lines = waiting_ / kLine;
        write_lines_of_half<false>(lines);
        write_lines_of_half<true>(lines);
        const std::size_t done = lines * kLine;
        column_ += done;
        std::copy(buffer_.data() + done * kLaneCount<D>, next(), buffer_.data());
        waiting_ -= done;
    }

    /// kUpper: which half of each square's rows.
    template <bool kUpper>
    HWY_INLINE void write_lines_of_half(std::size_t lines) {
        std::size_t line = 0;
        for (; line + 2 <= lines; line += 2) {
            write_half<2, kUpper>(line * kLine);
        }
        if (line < lines) {
            write_half<1, kUpper>(line * kLine);
        }
    }

    /// kLines lines from column `first` on. Two of them, of half the rows, are what registers hold.
    template <std::size_t kLines, bool kUpper>
    HWY_INLINE void write_half(std::size_t first) {
        const D d;
        constexpr std::size_t kHalf = kSquare<D> / 2;
        std::array<std::array<V<D>, kHalf>, 4 * kLines> squares;  // a line is four squares of either type
        for (std::size_t s = 0; s < squares.size(); ++s) {
            std::array<V<D>, kSquare<D>> columns;
            for (std::size_t j = 0; j < kSquare<D>; ++j) {
                columns[j] = hn::Load(d, buffer_.data() + (first + s * kSquare<D> + j) * kLaneCount<D>);
            }
            squares[s] = transpose_half<kUpper>(d, columns);
        }
        for (std::size_t j = 0; j < kHalf; ++j) {
            std::array<std::array<V<D>, 4>, kLines> lines;
            for (std::size_t k = 0; k < kLines; ++k) {
                lines[k] = {squares[4 * k][j], squares[4 * k + 1][j], squares[4 * k + 2][j], squares[4 * k + 3][j]};
                transpose_blocks(d, lines[k]);
            }
            write_rows(lines, j + (kUpper ? kHalf : 0), column_ + first);
        }
    }

    /// Row j of each square of lanes: its parts in lines[…][…], those of one row side by side.
    template <std::size_t kLines>
    HWY_INLINE void write_rows(const std::array<std::array<V<D>, 4>, kLines>& lines, std::size_t j,
                               std::size_t column) {
        const D d;
        constexpr std::size_t kParts = kLine / kLaneCount<D>;
        for (std::size_t i = 0; i < 4; i += kParts) {
            T* row = rows_[i / kParts * kSquare<D> + j] + column;
            for (std::size_t part = 0; part < kLines * kParts; ++part) {
                const auto values = lines[part / kParts][i + part % kParts];
                if (streamed_) {
                    hn::Stream(values, d, row + part * kLaneCount<D>);
                } else {
                    hn::StoreU(values, d, row + part * kLaneCount<D>);
                }
            }
        }
    }

    RowPointers<T> rows_;
    bool streamed_;
    std::size_t waiting_ = 0;
    std::size_t column_ = 0;
    alignas(64) std::array<T, kColumns * kLaneCount<D>> buffer_;
};

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
