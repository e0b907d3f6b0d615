// SPDX-License-Identifier: MIT
//
// Normalised associated Legendre functions in lanes, divided by sin^m θ so that they are finite and exact at the poles:
// P̂_l^m(z) = P̄_l^m(z) / sin^m θ, band after band (constants: legendre.h). Included once per instruction set.
#if defined(SHLIGHT_KERNELS_LEGENDRE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_LEGENDRE_INL_H_
#undef SHLIGHT_KERNELS_LEGENDRE_INL_H_
#else
#define SHLIGHT_KERNELS_LEGENDRE_INL_H_
#endif

#include <hwy/highway.h>

#include <array>
#include <cstddef>

#include "math/legendre.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// P̂_l^0 … P̂_l^l for l = 0, 1, 2, … in lanes.
///
/// kAtPole: for lanes near a pole, the recurrence (2) of docs/theory.md on the differences of R_l = P̂_l / P̂_l(1),
///   (l+m) (R_l - R_{l-1}) = (l-m-1) (R_{l-1} - R_{l-2}) - (2l-1) (1-|z|) R_{l-1},   1 - |z| = sin²θ / (1 + |z|),
/// with P̂_l^m(-z) = (-1)^(l-m) P̂_l^m(z). Other lanes take the usual recurrence, so callers must sort them.
template <class T, bool kAtPole>
class LegendreLanes {
    using D = Lanes<T>;

  public:
    LegendreLanes(V<D> z, V<D> sine_squared) : z_(z) {
        const D d;
        if constexpr (kAtPole) {
            distance_ = hn::Div(sine_squared, hn::Add(all(d, 1), hn::Abs(z)));
            put(state_, 0, all(d, 1));
        }
        put(row_, 0, hn::Set(d, constants_.diagonal[0]));
        put(other_, 0, hn::Zero(d));
    }

    /// P̂_l^m of the current band, m = 0 … l.
    HWY_INLINE V<D> operator[](std::size_t m) const { return get(row_, m); }

    /// Steps to the next band.
    HWY_INLINE void advance() {
        ++l_;
        if constexpr (kAtPole) {
            advance_near_pole();
        } else {
            advance_by_z();
        }
        put(row_, l_, hn::Set(D(), constants_.diagonal[l_]));
        put(other_, l_, hn::Zero(D()));
    }

  private:
    using Row = std::array<T, static_cast<std::size_t>(kMaxOrder) * kLaneCount<D>>;

    static HWY_INLINE V<D> get(const Row& row, std::size_t m) { return hn::Load(D(), row.data() + m * kLaneCount<D>); }
    static HWY_INLINE void put(Row& row, std::size_t m, V<D> value) {
        hn::Store(value, D(), row.data() + m * kLaneCount<D>);
    }

    /// other_ holds the previous band.
    HWY_INLINE void advance_by_z() {
        const D d;
        const T* step = &constants_.step[at(static_cast<int>(l_), 0)];
        const T* back = &constants_.back[at(static_cast<int>(l_), 0)];
        for (std::size_t m = 0; m < l_; ++m) {
            const auto now = get(row_, m);
            const auto before = hn::Mul(hn::Set(d, back[m]), get(other_, m));
            put(row_, m, hn::MulSub(hn::Mul(hn::Set(d, step[m]), z_), now, before));
            put(other_, m, now);
        }
    }

    /// state_ holds R_l, other_ the difference R_l - R_{l-1}.
    HWY_INLINE void advance_near_pole() {
        const D d;
        const T* at_pole = &constants_.at_pole[at(static_cast<int>(l_), 0)];
        const auto slope = hn::Mul(all(d, static_cast<double>(2 * l_ - 1)), distance_);
        const auto below = hn::Lt(z_, hn::Zero(d));
        for (std::size_t m = 0; m < l_; ++m) {
            const auto fall = hn::Mul(slope, get(state_, m));
            const auto rise = hn::MulSub(all(d, static_cast<double>(l_ - m - 1)), get(other_, m), fall);
            const auto difference = hn::Mul(rise, all(d, 1 / static_cast<double>(l_ + m)));
            const auto ratio = hn::Add(get(state_, m), difference);
            const auto value = hn::Mul(hn::Set(d, at_pole[m]), ratio);
            put(other_, m, difference);
            put(state_, m, ratio);
            put(row_, m, (l_ - m) % 2 == 1 ? hn::IfThenElse(below, hn::Neg(value), value) : value);
        }
        put(state_, l_, all(d, 1));
    }

    const LegendreConstants<T>& constants_ = LegendreConstants<T>::get();
    V<D> z_;
    V<D> distance_ = hn::Zero(D());
    std::size_t l_ = 0;
    alignas(64) Row row_;
    alignas(64) Row other_;
    alignas(64) Row state_;
};

/// cosine[m] + i sine[m] = scale · (x + iy)^m for m = 1 … count-1, and 1 for m = 0; kLaneCount values for each m. On
/// the unit circle these are cos mφ and sin mφ. The product is used since 2 cosφ · f_{m-1} - f_{m-2} loses digits.
template <class D>
HWY_INLINE void complex_powers_in_lanes(D d, V<D> x, V<D> y, double scale, std::size_t count, Scalar<D>* cosine,
                                        Scalar<D>* sine) {
    hn::Store(all(d, 1), d, cosine);
    hn::Store(hn::Zero(d), d, sine);
    auto re = hn::Mul(x, all(d, scale));
    auto im = hn::Mul(y, all(d, scale));
    for (std::size_t m = 1; m < count; ++m) {
        hn::Store(re, d, cosine + m * kLaneCount<D>);
        hn::Store(im, d, sine + m * kLaneCount<D>);
        const auto next = hn::MulSub(re, x, hn::Mul(im, y));
        im = hn::MulAdd(re, y, hn::Mul(im, x));
        re = next;
    }
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
