// SPDX-License-Identifier: MIT
//
// The circles inside which spheres are seen, one in each lane. Included once per instruction set.
#if defined(SHLIGHT_KERNELS_CAP_SPHERES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_CAP_SPHERES_INL_H_
#undef SHLIGHT_KERNELS_CAP_SPHERES_INL_H_
#else
#define SHLIGHT_KERNELS_CAP_SPHERES_INL_H_
#endif

#include <hwy/highway.h>

#include <limits>

#include "caps/cap_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// What the rounded product lacks of a².
template <class D>
HWY_INLINE V<D> square_error(D d, V<D> a, V<D> square) {
#if HWY_NATIVE_FMA
    (void)d;
    return hn::MulSub(a, a, square);
#else
    // Veltkamp's halves, whose products are exact.
    const auto split = hn::Mul(a, hn::Set(d, static_cast<Scalar<D> >(sizeof(Scalar<D>) == 4 ? 4097.0 : 134217729.0)));
    const auto high = hn::Sub(split, hn::Sub(split, a));
    const auto low = hn::Sub(a, high);
    const auto crossed = hn::Mul(high, low);
    const auto rest = hn::Add(hn::Sub(hn::Mul(high, high), square), hn::Add(crossed, crossed));
    return hn::Add(rest, hn::Mul(low, low));
#endif
}

/// |c|² - r² without the cancellation of |c| ≈ r, in doubled precision (Ogita, Rump & Oishi 2005, Dot2).
template <class D>
HWY_INLINE V<D> tangent_squared(D d, V<D> x, V<D> y, V<D> z, V<D> r) {
    const auto first = hn::Mul(r, r);
    auto high = hn::Neg(first);
    auto low = hn::Neg(square_error(d, r, first));
    const auto add = [&](V<D> v) HWY_ATTR {
        const auto square = hn::Mul(v, v);
        const auto sum = hn::Add(high, square);
        const auto rest = hn::Sub(sum, high);
        const auto lost = hn::Add(hn::Sub(high, hn::Sub(sum, rest)), hn::Sub(square, rest));
        low = hn::Add(low, hn::Add(lost, square_error(d, v, square)));
        high = sum;
    };
    add(x);
    add(y);
    add(z);
    return hn::Add(high, low);
}

/// A power of two by which no vector is so small or so large that its square would leave the range.
template <class D>
HWY_INLINE V<D> safe_scale(D d, V<D> x, V<D> y, V<D> z) {
    using T = Scalar<D>;
    const hn::RebindToUnsigned<D> du;
    using U = hn::TFromD<decltype(du)>;
    constexpr int kBits = sizeof(T) == 4 ? 23 : 52;
    constexpr U kLargest = sizeof(T) == 4 ? 254 : 2046;
    constexpr U kExponent = (2 * ((kLargest / 2) + 1) - 1) << kBits;
    // Of the largest normal numbers the inverse would be denormal.
    const auto most = hn::Set(d, std::numeric_limits<T>::max() / 8);
    const auto largest = hn::Min(most, hn::Max(hn::Abs(x), hn::Max(hn::Abs(y), hn::Abs(z))));
    const auto exponent = hn::And(hn::BitCast(du, largest), hn::Set(du, kExponent));
    return hn::BitCast(d, hn::Sub(hn::Set(du, kLargest << kBits), exponent));
}

/// As circle_of_sphere (warp.h), with where it crosses the plane z = 0: sin²σ - L_z² from centre and radius.
template <class D>
HWY_INLINE CircleLanes<D> circle_of_sphere_in_lanes(D d, V<D> x, V<D> y, V<D> z, V<D> r) {
    const auto scale = safe_scale(d, x, y, z);
    x = hn::Mul(x, scale);
    y = hn::Mul(y, scale);
    z = hn::Mul(z, scale);
    r = hn::Mul(r, scale);
    const auto square = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
    const auto inverse = hn::Div(all(d, 1), hn::Sqrt(square));
    const auto crossing = hn::Mul(hn::Mul(hn::Sub(r, z), inverse), hn::Mul(hn::Add(r, z), inverse));
    const auto ux = hn::Mul(x, inverse);
    const auto uy = hn::Mul(y, inverse);
    return {ux,
            uy,
            hn::Mul(z, inverse),
            hn::Mul(root(d, tangent_squared(d, x, y, z, r)), inverse),
            hn::Min(all(d, 1), hn::Mul(r, inverse)),
            hn::MulAdd(ux, ux, hn::Mul(uy, uy)),
            crossing};
}

/// The same for floats, which fill half a vector of doubles: their products are exact there, and in range.
struct HalfSpheres {
    V<Doubles> z, tangent_squared, tilt_squared, crossing_squared;
    V<Doubles> inverse;

    HWY_INLINE HalfSpheres(V<Doubles> x, V<Doubles> y, V<Doubles> own_z, V<Doubles> r) {
        const Doubles d;
        const auto across = hn::MulAdd(x, x, hn::Mul(y, y));
        const auto square = hn::MulAdd(own_z, own_z, across);
        const auto inverse_square = hn::Div(all(d, 1), square);
        inverse = hn::Sqrt(inverse_square);
        z = hn::Mul(own_z, inverse);
        tangent_squared = hn::Mul(hn::NegMulAdd(r, r, square), inverse_square);
        tilt_squared = hn::Mul(across, inverse_square);
        crossing_squared = hn::Mul(hn::Mul(hn::Sub(r, own_z), hn::Add(r, own_z)), inverse_square);
    }
};

/// All of it in doubles.
HWY_INLINE CircleLanes<Doubles> circle_of_floats(V<Doubles> x, V<Doubles> y, V<Doubles> z, V<Doubles> r) {
    const Doubles d;
    const HalfSpheres half(x, y, z, r);
    return {hn::Mul(x, half.inverse),
            hn::Mul(y, half.inverse),
            half.z,
            root(d, half.tangent_squared),
            hn::Min(all(d, 1), hn::Mul(r, half.inverse)),
            half.tilt_squared,
            half.crossing_squared};
}

/// Only what errors would be multiplied by the order needs the doubles.
HWY_INLINE CircleLanes<Floats> circle_of_sphere_in_lanes(Floats d, V<Floats> x, V<Floats> y, V<Floats> z, V<Floats> r) {
    const Doubles dd;
    const hn::Half<Floats> half;
    const auto low = [&](V<Floats> v) HWY_ATTR { return hn::PromoteTo(dd, hn::LowerHalf(half, v)); };
    const auto high = [&](V<Floats> v) HWY_ATTR { return hn::PromoteTo(dd, hn::UpperHalf(half, v)); };
    const HalfSpheres a(low(x), low(y), low(z), low(r));
    const HalfSpheres b(high(x), high(y), high(z), high(r));
    const auto inverse = narrowed<float>(a.inverse, b.inverse);
    return {hn::Mul(x, inverse),
            hn::Mul(y, inverse),
            narrowed<float>(a.z, b.z),
            root(d, narrowed<float>(a.tangent_squared, b.tangent_squared)),
            hn::Min(all(d, 1), hn::Mul(r, inverse)),
            narrowed<float>(a.tilt_squared, b.tilt_squared),
            narrowed<float>(a.crossing_squared, b.crossing_squared)};
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
