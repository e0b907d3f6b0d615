// SPDX-License-Identifier: MIT
//
// Points on arcs, side by side in vector registers.
#pragma once

#include <array>

#include "gauss_legendre.h"
#include "shlight/types.h"

namespace shlight {

/// As many numbers side by side as the smallest vector registers hold: the vector type of GCC and Clang, every operator
/// of which is one instruction. Loops over arrays of lanes would be left to the compiler, which unrolls them instead.
template <class R>
struct PackOf;
template <>
struct PackOf<float> {
    using type = float __attribute__((vector_size(16)));
};
template <>
struct PackOf<double> {
    using type = double __attribute__((vector_size(16)));
};
template <class R>
using Pack = typename PackOf<R>::type;

template <class R>
inline constexpr int kLanes = 16 / static_cast<int>(sizeof(R));

template <class R>
Pack<R> all(R x) {
    return Pack<R>{} + x;
}

inline double sum_of(const Pack<double>& pack) {
    return pack[0] + pack[1];
}
inline double sum_of(const Pack<float>& pack) {
    return static_cast<double>((pack[0] + pack[1]) + (pack[2] + pack[3]));
}

/// Points u on the boundary of a region, each with ν ds times its weight, ν the inward normal. Those of several arcs go
/// through the recurrences together.
template <class R>
class PointBatch {
  public:
    static constexpr int kPoints = kMaxGaussPoints;
    static constexpr int kPacks = kPoints / kLanes<R>;
    using Values = std::array<Pack<R>, kPacks>;

    Values x, y, z, normal_x, normal_y, normal_z;

    int size() const { return size_; }
    int packs() const { return (size_ + kLanes<R> - 1) / kLanes<R>; }
    void clear() { size_ = 0; }

    void add(const Vec3<R>& u, const Vec3<R>& normal) {
        const int pack = size_ / kLanes<R>;
        const int lane = size_ % kLanes<R>;
        x[pack][lane] = u.x;
        y[pack][lane] = u.y;
        z[pack][lane] = u.z;
        normal_x[pack][lane] = normal.x;
        normal_y[pack][lane] = normal.y;
        normal_z[pack][lane] = normal.z;
        ++size_;
    }
    /// Adds points without weight up to a multiple of `count` points.
    void pad(int count) {
        while (size_ % count != 0) {
            add({0, 0, 1}, Vec3<R>(0));
        }
    }

  private:
    int size_ = 0;
};

}  // namespace shlight
