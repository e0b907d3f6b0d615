// SPDX-License-Identifier: MIT
//
// Types and functions that all batch kernels use; a lane holds one shading point. Included once per instruction set.
#if defined(SHLIGHT_KERNELS_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_LANES_INL_H_
#undef SHLIGHT_KERNELS_LANES_INL_H_
#else
#define SHLIGHT_KERNELS_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Vectors of as many lanes as the machine has.
using Floats = hn::ScalableTag<float>;
using Doubles = hn::ScalableTag<double>;
template <class T>
using Lanes = hn::ScalableTag<T>;
template <class D>
using V = hn::Vec<D>;
template <class D>
using M = hn::Mask<D>;
template <class D>
using Scalar = hn::TFromD<D>;

template <class D>
inline constexpr std::size_t kLaneCount = hn::MaxLanes(D());

template <class D>
HWY_INLINE V<D> all(D d, double value) {
    return hn::Set(d, static_cast<Scalar<D>>(value));
}

/// √max(0, x), for numbers that only rounding can make negative.
template <class D>
HWY_INLINE V<D> root(D d, V<D> x) {
    return hn::Sqrt(hn::Max(hn::Zero(d), x));
}

/// (atan t - t) / t³ as a polynomial in t² for t² ≤ tan²(π/8), by Chebyshev interpolation. Error of the arctangent
/// relative to t: 2.7e-9 in float, 5.5e-18 in double.
template <class D>
HWY_INLINE V<D> arctangent_rest(D d, V<D> square) {
    if constexpr (std::is_same_v<Scalar<D>, float>) {
        auto sum = all(d, -0.06451928208121748758);
        sum = hn::MulAdd(sum, square, all(d, 0.10743731490791083043));
        sum = hn::MulAdd(sum, square, all(d, -0.14263955597984639199));
        sum = hn::MulAdd(sum, square, all(d, 0.19999540483648963445));
        return hn::MulAdd(sum, square, all(d, -0.33333331761168519851));
    } else {
        auto sum = all(d, -0.019176887119062258989);
        sum = hn::MulAdd(sum, square, all(d, 0.039231658295587191303));
        sum = hn::MulAdd(sum, square, all(d, -0.050854497379402598613));
        sum = hn::MulAdd(sum, square, all(d, 0.058581489128022098816));
        sum = hn::MulAdd(sum, square, all(d, -0.066645114473819480001));
        sum = hn::MulAdd(sum, square, all(d, 0.076921831908260865637));
        sum = hn::MulAdd(sum, square, all(d, -0.090909045781239018905));
        sum = hn::MulAdd(sum, square, all(d, 0.11111111015256361727));
        sum = hn::MulAdd(sum, square, all(d, -0.14285714284666542922));
        sum = hn::MulAdd(sum, square, all(d, 0.19999999999995520678));
        return hn::MulAdd(sum, square, all(d, -0.3333333333333333016));
    }
}

/// The angle of the point (x, y) in -π … π, as std::atan2 except for signed zeros; 0 for (0, 0). There is one division:
/// in the octant 0 ≤ y ≤ x the tangent is y/x below π/8, and (y-x)/(y+x), an eighth of a turn further, above.
template <class D>
HWY_INLINE V<D> arctangent(D d, V<D> y, V<D> x) {
    constexpr double kPi = std::numbers::pi;
    const auto ax = hn::Abs(x);
    const auto ay = hn::Abs(y);
    const auto least = hn::Min(ax, ay);
    const auto most = hn::Max(ax, ay);
    const auto steep = hn::Gt(least, hn::Mul(most, all(d, 0.41421356237309503)));
    const auto over = hn::IfThenElse(steep, hn::Sub(least, most), least);
    const auto under = hn::IfThenElse(steep, hn::Add(least, most), most);
    const auto t = hn::IfThenElseZero(hn::Gt(most, hn::Zero(d)), hn::Div(over, under));
    const auto square = hn::Mul(t, t);
    auto angle = hn::MulAdd(hn::Mul(t, square), arctangent_rest(d, square), t);
    angle = hn::Add(angle, hn::IfThenElseZero(steep, all(d, kPi / 4)));
    angle = hn::IfThenElse(hn::Gt(ay, ax), hn::Sub(all(d, kPi / 2), angle), angle);
    angle = hn::IfThenElse(hn::Lt(x, hn::Zero(d)), hn::Sub(all(d, kPi), angle), angle);
    return hn::CopySign(angle, y);
}

/// a b - product, where product is a b rounded: exact.
HWY_INLINE V<Doubles> product_error(V<Doubles> a, V<Doubles> b, V<Doubles> product) {
#if HWY_NATIVE_FMA
    return hn::MulSub(a, b, product);
#else
    const Doubles d;  // Dekker 1971: the products of halves of the digits are exact
    const auto upper = [&](V<Doubles> x) HWY_ATTR {
        const auto shifted = hn::Mul(x, all(d, 134217729));
        return hn::Sub(shifted, hn::Sub(shifted, x));
    };
    const auto a1 = upper(a);
    const auto b1 = upper(b);
    const auto a2 = hn::Sub(a, a1);
    const auto b2 = hn::Sub(b, b1);
    const auto rest = hn::Add(hn::Sub(hn::Mul(a1, b1), product), hn::Add(hn::Mul(a1, b2), hn::Mul(a2, b1)));
    return hn::Add(rest, hn::Mul(a2, b2));
#endif
}

/// The power of two by which numbers, finite and not negative, are 1 … 2, or closer to it than before.
HWY_INLINE V<Doubles> power_of_two_scale(V<Doubles> largest) {
    const Doubles d;
    const hn::RebindToUnsigned<Doubles> du;
    // The inverse of the largest normal numbers would be denormal.
    const auto capped = hn::Min(largest, hn::Set(d, std::numeric_limits<double>::max() / 8));
    const auto exponent = hn::And(hn::BitCast(du, capped), hn::Set(du, std::uint64_t{2047} << 52));
    return hn::BitCast(d, hn::Sub(hn::Set(du, std::uint64_t{2046} << 52), exponent));
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
