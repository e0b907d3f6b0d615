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

#include <cstdint>
#include <limits>

#include "regions/cap_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// What the rounded product lacks of a².
HWY_INLINE V<Doubles> square_error(V<Doubles> a, V<Doubles> square) {
#if HWY_NATIVE_FMA
    return hn::MulSub(a, a, square);
#else
    // Veltkamp's halves, whose products are exact.
    const auto split = hn::Mul(a, hn::Set(Doubles(), 134217729.0));
    const auto high = hn::Sub(split, hn::Sub(split, a));
    const auto low = hn::Sub(a, high);
    const auto crossed = hn::Mul(high, low);
    const auto rest = hn::Add(hn::Sub(hn::Mul(high, high), square), hn::Add(crossed, crossed));
    return hn::Add(rest, hn::Mul(low, low));
#endif
}

/// |c|² - r² without the cancellation of |c| ≈ r, in doubled precision (Ogita, Rump & Oishi 2005, Dot2).
HWY_INLINE V<Doubles> tangent_squared(V<Doubles> x, V<Doubles> y, V<Doubles> z, V<Doubles> r) {
    const auto first = hn::Mul(r, r);
    auto high = hn::Neg(first);
    auto low = hn::Neg(square_error(r, first));
    const auto add = [&](V<Doubles> v) HWY_ATTR {
        const auto square = hn::Mul(v, v);
        const auto sum = hn::Add(high, square);
        const auto rest = hn::Sub(sum, high);
        const auto lost = hn::Add(hn::Sub(high, hn::Sub(sum, rest)), hn::Sub(square, rest));
        low = hn::Add(low, hn::Add(lost, square_error(v, square)));
        high = sum;
    };
    add(x);
    add(y);
    add(z);
    return hn::Add(high, low);
}

/// A power of two by which no vector is so small or so large that its square would leave the range.
HWY_INLINE V<Doubles> safe_scale(V<Doubles> x, V<Doubles> y, V<Doubles> z) {
    const Doubles d;
    const hn::RebindToUnsigned<Doubles> du;
    // Of the largest normal numbers the inverse would be denormal.
    const auto most = hn::Set(d, std::numeric_limits<double>::max() / 8);
    const auto largest = hn::Min(most, hn::Max(hn::Abs(x), hn::Max(hn::Abs(y), hn::Abs(z))));
    const auto exponent = hn::And(hn::BitCast(du, largest), hn::Set(du, std::uint64_t{2047} << 52));
    return hn::BitCast(d, hn::Sub(hn::Set(du, std::uint64_t{2046} << 52), exponent));
}

/// What of a circle needs doubles whatever it is for. T: what the sphere was given in; products of floats are exact in
/// doubles, and in range. Numbers of doubles are scaled.
template <class T>
struct SphereRatios {
    V<Doubles> inverse;  // of |c|
    V<Doubles> z, cosine_squared, tilt_squared, crossing_squared;

    HWY_INLINE SphereRatios(V<Doubles>& x, V<Doubles>& y, V<Doubles>& own_z, V<Doubles>& r) {
        const Doubles d;
        constexpr bool kExact = sizeof(T) == 4;
        if constexpr (!kExact) {
            const auto scale = safe_scale(x, y, own_z);
            x = hn::Mul(x, scale);
            y = hn::Mul(y, scale);
            own_z = hn::Mul(own_z, scale);
            r = hn::Mul(r, scale);
        }
        const auto across = hn::MulAdd(x, x, hn::Mul(y, y));
        const auto square = hn::MulAdd(own_z, own_z, across);
        const auto inverse_square = hn::Div(all(d, 1), square);
        const auto tangent = kExact ? hn::NegMulAdd(r, r, square) : tangent_squared(x, y, own_z, r);
        inverse = hn::Sqrt(inverse_square);
        z = hn::Mul(own_z, inverse);
        cosine_squared = hn::Mul(tangent, inverse_square);
        tilt_squared = hn::Mul(across, inverse_square);
        crossing_squared = hn::Mul(hn::Mul(hn::Sub(r, own_z), hn::Add(r, own_z)), inverse_square);
    }
};

/// cap_of_sphere (boost.h), with where it crosses the plane z = 0 from centre and radius.
template <class T>
HWY_INLINE SphericalCapLanes<Doubles> cap_of_sphere_in_lanes(V<Doubles> x, V<Doubles> y, V<Doubles> z, V<Doubles> r) {
    const Doubles d;
    const SphereRatios<T> ratios(x, y, z, r);
    return {hn::Mul(x, ratios.inverse),
            hn::Mul(y, ratios.inverse),
            ratios.z,
            root(d, ratios.cosine_squared),
            hn::Min(all(d, 1), hn::Mul(r, ratios.inverse)),
            ratios.tilt_squared,
            ratios.crossing_squared};
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
