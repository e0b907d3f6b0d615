// SPDX-License-Identifier: MIT
//
// Boosts in lanes of double, and the images of caps under them (docs/theory.md, 6.1). Included once per instruction
// set.
#if defined(SHLIGHT_KERNELS_BOOST_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_BOOST_LANES_INL_H_
#undef SHLIGHT_KERNELS_BOOST_LANES_INL_H_
#else
#define SHLIGHT_KERNELS_BOOST_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include "simd/lanes-inl.h"
#include "simd/lobe_arrays.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// Vectors of the space in lanes.
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

/// The members of Boost (shlight/boost.h), a boost in each lane.
struct BoostLanes {
    using D = Doubles;
    V<D> sin_tilt, cos_tilt;
    V<D> speed, one_minus_speed, gamma;
    V<D> horizon_x, horizon_z;
    V<D> horizon_height, horizon_sine;

    /// The image of a cap: its axis, the cosine of its half angle, and the factor by which the sine of the half angle
    /// grows.
    struct Image {
        Vectors3<double> axis;
        V<D> cosine, sine_ratio;
    };
    /// A boost is a Lorentz transform of the caps' 4-vectors (cosine; axis). Strong ones would cancel the differences
    /// from 1: those of L_∥, the axis' part along the boost, and of the cosine are taken for themselves.
    HWY_INLINE Image image(const Vectors3<double>& axis, V<D> one_minus_cos) const {
        const D d;
        const Vectors3<double> off = {hn::Add(axis.x, sin_tilt), axis.y, hn::Sub(axis.z, cos_tilt)};
        const auto gap = hn::Mul(all(d, 0.5), dot<double>(off, off));  // 1 - L_∥
        const auto across = hn::MulAdd(cos_tilt, axis.x, hn::Mul(sin_tilt, axis.z));
        // γ (L_∥ - b cosσ) and γ (cosσ - b L_∥)
        const auto along = hn::Mul(gamma, hn::MulAdd(speed, one_minus_cos, hn::Sub(one_minus_speed, gap)));
        const auto cosine = hn::Mul(gamma, hn::MulAdd(speed, gap, hn::Sub(one_minus_speed, one_minus_cos)));
        const Vectors3<double> image = {hn::MulSub(horizon_z, across, hn::Mul(horizon_x, along)), axis.y,
                                        hn::MulAdd(horizon_x, across, hn::Mul(horizon_z, along))};
        const auto ratio = hn::Div(all(d, 1), hn::Sqrt(dot<double>(image, image)));
        return {scaled<double>(image, ratio), hn::Mul(cosine, ratio), ratio};
    }
};

/// Boosts of as many lobes as there are lanes for float.
struct BoostPair {
    BoostLanes low, high;
};

/// Boosts from arrays. load(array): the numbers of a vector.
template <class Load>
HWY_INLINE BoostLanes load_boosts(const BoostArrays& boosts, const Load& load) {
    return {load(boosts.sin_tilt),        load(boosts.cos_tilt),       load(boosts.speed),
            load(boosts.one_minus_speed), load(boosts.gamma),          load(boosts.horizon_x),
            load(boosts.horizon_z),       load(boosts.horizon_height), load(boosts.horizon_sine)};
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
