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

#include <array>
#include <cstddef>
#include <cstring>

#include "kernels/lanes-inl.h"
#include "shlight/types.h"

HWY_BEFORE_NAMESPACE();
namespace shlight {
namespace HWY_NAMESPACE {

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

/// Collects the columns of a matrix as lanes and writes them to rows, a cache line of each row at a time.
/// T: float or double; wide enough for a band at a time.
template <class T>
class RowWriter {
  public:
    explicit RowWriter(const RowPointers<T>& rows) : rows_(rows) {}

    /// Where the next columns go, column after column of kLaneCount values each, at most 2 kMaxOrder - 1 of them.
    T* next() { return buffer_ + waiting_ * kLaneCount<D>; }

    /// So many columns were put there.
    void add(std::size_t columns) {
        waiting_ += columns;
        std::size_t done = 0;
        for (; done + kLine <= waiting_; done += kLine) {
            write_line(done);
        }
        std::memmove(buffer_, buffer_ + done * kLaneCount<D>, (waiting_ - done) * kLaneCount<D> * sizeof(T));
        waiting_ -= done;
    }

    /// Writes what waits.
    void finish() {
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
    static constexpr std::size_t kColumns = 2 * kMaxOrder + kLine;

    HWY_INLINE void write_line(std::size_t first) {
        const D d;
        constexpr std::size_t kSquares = kLine / kSquare<D>;
        std::array<std::array<V<D>, kSquare<D>>, kSquares> squares;
        for (std::size_t s = 0; s < kSquares; ++s) {
            for (std::size_t j = 0; j < kSquare<D>; ++j) {
                squares[s][j] = hn::Load(d, buffer_ + (first + s * kSquare<D> + j) * kLaneCount<D>);
            }
            transpose_squares(d, squares[s]);
        }
        for (std::size_t j = 0; j < kSquare<D>; ++j) {
            for (std::size_t s = 0; s < kSquares; ++s) {
                store_blocks(d, squares[s][j], rows_.data() + j, column_ + s * kSquare<D>);
            }
        }
        column_ += kLine;
    }

    RowPointers<T> rows_;
    std::size_t waiting_ = 0;
    std::size_t column_ = 0;
    alignas(64) T buffer_[kColumns * kLaneCount<D>];
};

}  // namespace HWY_NAMESPACE
}  // namespace shlight
HWY_AFTER_NAMESPACE();

#endif
