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

/// v[j]: column j of all lanes → row j of each block's lanes. Block b of the result's v[j] is lane b · kSquare + j.
template <class D>
HWY_INLINE void transpose_squares(D d, std::array<V<D>, kSquare<D>>& v) {
    if constexpr (kSquare<D> == 4) {
        const auto even_low = hn::InterleaveLower(d, v[0], v[2]);
        const auto even_high = hn::InterleaveUpper(d, v[0], v[2]);
        const auto odd_low = hn::InterleaveLower(d, v[1], v[3]);
        const auto odd_high = hn::InterleaveUpper(d, v[1], v[3]);
        v[0] = hn::InterleaveLower(d, even_low, odd_low);
        v[1] = hn::InterleaveUpper(d, even_low, odd_low);
        v[2] = hn::InterleaveLower(d, even_high, odd_high);
        v[3] = hn::InterleaveUpper(d, even_high, odd_high);
    } else {
        const auto low = hn::InterleaveLower(d, v[0], v[1]);
        v[1] = hn::InterleaveUpper(d, v[0], v[1]);
        v[0] = low;
    }
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
    void write_lines() {
        std::size_t done = 0;
        for (; done + kLine <= waiting_; done += kLine) {
            write_line(done);
        }
        std::copy(buffer_.data() + done * kLaneCount<D>, next(), buffer_.data());
        waiting_ -= done;
    }

    HWY_INLINE void write_line(std::size_t first) {
        const D d;
        std::array<std::array<V<D>, kSquare<D>>, 4> squares;  // a line is four squares of either type
        for (std::size_t s = 0; s < 4; ++s) {
            for (std::size_t j = 0; j < kSquare<D>; ++j) {
                squares[s][j] = hn::Load(d, buffer_.data() + (first + s * kSquare<D> + j) * kLaneCount<D>);
            }
            transpose_squares(d, squares[s]);
        }
        for (std::size_t j = 0; j < kSquare<D>; ++j) {
            std::array<V<D>, 4> q = {squares[0][j], squares[1][j], squares[2][j], squares[3][j]};
            transpose_blocks(d, q);
            constexpr std::size_t kParts = kLine / kLaneCount<D>;
            for (std::size_t i = 0; i < 4; ++i) {
                T* row = rows_[i / kParts * kSquare<D> + j] + column_ + i % kParts * kLaneCount<D>;
                if (streamed_) {
                    hn::Stream(q[i], d, row);
                } else {
                    hn::StoreU(q[i], d, row);
                }
            }
        }
        column_ += kLine;
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
