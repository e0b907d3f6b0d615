// SPDX-License-Identifier: MIT
//
// Gauss points on circular arcs, one arc a lane (docs/theory.md, 4.2 and 4.7). Included once per instruction set.
#if defined(SHLIGHT_KERNELS_ARC_POINTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_ARC_POINTS_INL_H_
#undef SHLIGHT_KERNELS_ARC_POINTS_INL_H_
#else
#define SHLIGHT_KERNELS_ARC_POINTS_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>

#include "math/gauss_legendre.h"
#include "regions/arc_rows.h"
#include "simd/lanes-inl.h"
#include "simd/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

template <class R>
struct Vectors3 {
    V<Lanes<R>> x, y, z;
};

template <class R>
HWY_INLINE Vectors3<R> cross(const Vectors3<R>& a, const Vectors3<R>& b) {
    return {hn::MulSub(a.y, b.z, hn::Mul(a.z, b.y)), hn::MulSub(a.z, b.x, hn::Mul(a.x, b.z)),
            hn::MulSub(a.x, b.y, hn::Mul(a.y, b.x))};
}

template <class R>
HWY_INLINE V<Lanes<R>> dot(const Vectors3<R>& a, const Vectors3<R>& b) {
    return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

template <class R>
HWY_INLINE Vectors3<R> operator+(const Vectors3<R>& a, const Vectors3<R>& b) {
    return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}

template <class R>
HWY_INLINE Vectors3<R> operator-(const Vectors3<R>& a, const Vectors3<R>& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

template <class R>
HWY_INLINE Vectors3<R> scaled(const Vectors3<R>& a, V<Lanes<R>> s) {
    return {hn::Mul(a.x, s), hn::Mul(a.y, s), hn::Mul(a.z, s)};
}

template <class R>
struct SineCosine {
    V<Lanes<R>> sine, cosine;
};

/// Of angles in -π/2 … π/2, as polynomials in their square; largest error 2e-8 and 2e-17 (Chebyshev interpolation).
template <class R>
HWY_INLINE SineCosine<R> of_quarter_turn(V<Lanes<R>> angle) {
    const Lanes<R> d;
    const auto y = hn::Mul(angle, angle);
    const auto polynomial = [&](const auto& coefficients) HWY_ATTR {
        auto sum = hn::Zero(d);
        for (std::size_t i = coefficients.size(); i-- > 0;) {
            sum = hn::MulAdd(sum, y, all(d, coefficients[i]));
        }
        return sum;
    };
    if constexpr (std::is_same_v<R, float>) {
        constexpr std::array<double, 4> kSine = {-0.1666666596382118729, 0.0083332421350969387576,
                                                 -0.00019822739488631101798, 2.6347563918117812731e-6};
        constexpr std::array<double, 5> kCosine = {-0.49999999963953022676, 0.041666659360024926605,
                                                   -0.0013888651647261390631, 0.000024774579745194932456,
                                                   -2.6297517416492885068e-7};
        return {hn::MulAdd(hn::Mul(angle, y), polynomial(kSine), angle), hn::MulAdd(y, polynomial(kCosine), all(d, 1))};
    } else {
        constexpr std::array<double, 8> kSine = {-0.16666666666666666633,    0.0083333333333333158688,
                                                 -0.00019841269841254973769, 2.7557319219163233416e-6,
                                                 -2.5052107616996182891e-8,  1.6058977312464087621e-10,
                                                 -7.6439702967985720524e-13, 2.7314447669863993424e-15};
        constexpr std::array<double, 8> kCosine = {
            -0.49999999999999999362,   0.04166666666666633566,   -0.0013888888888860709697,  0.000024801587292446212237,
            -2.7557317767320528541e-7, 2.0876630867422995287e-9, -1.1464689885720027995e-11, 4.6276759850181717831e-14};
        return {hn::MulAdd(hn::Mul(angle, y), polynomial(kSine), angle), hn::MulAdd(y, polynomial(kCosine), all(d, 1))};
    }
}

/// Of angles in -π … π.
template <class R>
HWY_INLINE SineCosine<R> of_half_turn(V<Lanes<R>> angle) {
    const Lanes<R> d;
    const SineCosine<R> half = of_quarter_turn<R>(hn::Mul(angle, all(d, 0.5)));
    const auto twice = hn::Add(half.sine, half.sine);
    return {hn::Mul(twice, half.cosine), hn::NegMulAdd(twice, half.sine, all(d, 1))};
}

/// Columns `column` … `column + kSquare - 1` of rows that follow each other, one a lane.
template <class D, class Row>
HWY_INLINE V<D> load_row_blocks(D d, const Row* rows, std::size_t column) {
    if constexpr (hn::MaxLanes(d) > kSquare<D>) {
        const hn::Half<D> half;
        return hn::Combine(d, load_row_blocks(half, rows + hn::MaxLanes(half), column),
                           load_row_blocks(half, rows, column));
    } else {
        return hn::LoadU(d, rows->data() + column);
    }
}
template <class D, class Row>
HWY_INLINE std::array<V<D>, kSquare<D>> load_row_columns(D d, const Row* rows, std::size_t column) {
    std::array<V<D>, kSquare<D>> v;
    for (std::size_t j = 0; j < kSquare<D>; ++j) {
        v[j] = load_row_blocks(d, rows + j, column);
    }
    transpose_squares(d, v);
    return v;
}

/// Points u of arcs, with ν ds ÷ (weight · 2 half), ν the inward normal.
template <class R>
struct ArcPoints {
    Vectors3<R> u, normal;
};

/// Arcs in lanes. kGreat: all are of great circles.
template <class R, bool kGreat>
class ArcLanes {
    using D = Lanes<R>;

  public:
    /// rows: one arc a lane.
    explicit HWY_INLINE ArcLanes(const ArcRow<R>* rows) {
        const D d;
        std::array<V<D>, 12> v;
        constexpr std::size_t kColumns = kGreat ? 8 : 12;
        for (std::size_t c = 0; c < kColumns; c += kSquare<D>) {
            const auto columns = load_row_columns(d, rows, c);
            for (std::size_t j = 0; j < kSquare<D>; ++j) {
                v[c + j] = columns[j];
            }
        }
        axis_ = {v[0], v[1], v[2]};
        half_ = v[3];
        middle_ = {v[4], v[5], v[6]};
        across_ = cross<R>(axis_, middle_);
        if constexpr (!kGreat) {
            cosine_ = v[8];
            sine_ = v[9];
            center_ = scaled<R>(axis_, cosine_);
            normal_ = scaled<R>(axis_, hn::Mul(sine_, sine_));
        }
    }

    V<D> angle() const { return hn::Add(half_, half_); }

    /// The point at `fraction` of the half angle from the middle, and its mirror image.
    HWY_INLINE std::array<ArcPoints<R>, 2> pair(double fraction) const {
        const auto turn = hn::Mul(half_, all(D(), fraction));
        if constexpr (kGreat) {
            const SineCosine<R> t = of_quarter_turn<R>(turn);
            const Vectors3<R> base = scaled<R>(middle_, t.cosine);
            const Vectors3<R> side = scaled<R>(across_, t.sine);
            return {ArcPoints<R>{base - side, axis_}, {base + side, axis_}};
        } else {
            const SineCosine<R> t = of_half_turn<R>(turn);
            const Vectors3<R> base = scaled<R>(middle_, hn::Mul(sine_, t.cosine));
            const Vectors3<R> side = scaled<R>(across_, hn::Mul(sine_, t.sine));
            return {at(base - side), at(base + side)};
        }
    }

    HWY_INLINE ArcPoints<R> middle() const {
        if constexpr (kGreat) {
            return {middle_, axis_};
        } else {
            return at(scaled<R>(middle_, sine_));
        }
    }

  private:
    /// radius: from the circle's middle. ν ds/dψ = axis - cosine u = sine² axis - cosine radius, where nothing cancels.
    HWY_INLINE ArcPoints<R> at(const Vectors3<R>& radius) const {
        return {center_ + radius, normal_ - scaled<R>(radius, cosine_)};
    }

    Vectors3<R> axis_, middle_, across_, center_, normal_;
    V<D> half_, cosine_, sine_;
};

/// The columns of HorizonRow.
template <class R>
HWY_INLINE std::array<V<Lanes<R>>, 8> horizon_columns(const HorizonRow<R>* rows) {
    const Lanes<R> d;
    std::array<V<Lanes<R>>, 8> v;
    for (std::size_t c = 0; c < v.size(); c += kSquare<Lanes<R>>) {
        const auto columns = load_row_columns(d, rows, c);
        for (std::size_t j = 0; j < columns.size(); ++j) {
            v[c + j] = columns[j];
        }
    }
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

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
