// SPDX-License-Identifier: MIT
//
// Views of a lobe, one in each lane: where they lie among those that were fitted, and their warps. Included once per
// instruction set.
#if defined(SHLIGHT_KERNELS_VIEWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_VIEWS_INL_H_
#undef SHLIGHT_KERNELS_VIEWS_INL_H_
#else
#define SHLIGHT_KERNELS_VIEWS_INL_H_
#endif

#include <hwy/highway.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <hwy/contrib/math/math-inl.h>

#include "caps/cap_lanes-inl.h"
#include "lobes/fit_table.h"
#include "lobes/view_lanes-inl.h"
#include "shlight/warped_fit.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

template <class Function>
HWY_INLINE DoublePair each(const Function& function, const DoublePair& a) {
    return {function(a.low), function(a.high)};
}

HWY_INLINE V<Doubles> sine_of_cosine(V<Doubles> cosine) {
    const auto one = all(Doubles(), 1);
    return hn::Sqrt(hn::Mul(hn::Sub(one, cosine), hn::Add(one, cosine)));
}

/// The view's neighbour that is fitted, and where it lies in a table of one row for each fitted view, before which
/// stands the row of the view beyond the normal: the first of four rows, and four cubic weights.
struct ViewLanes {
    DoublePair cosine, sine;
    V<Floats> log_cosine;
    V<hn::RebindToSigned<Floats>> row;
    std::array<V<Floats>, 4> weights;
};

HWY_INLINE ViewLanes view_in_lanes(const DoublePair& cos_theta_o) {
    const Floats d;
    const hn::RebindToSigned<Floats> di;
    const auto step = static_cast<float>((kWarpedViews - 1) / std::acosh(1 / kLeastFittedCosine));
    ViewLanes view;
    view.cosine =
        each([](V<Doubles> c)
                 HWY_ATTR { return hn::Min(hn::Max(c, all(Doubles(), kLeastFittedCosine)), all(Doubles(), 1)); },
             cos_theta_o);
    view.sine = each([](V<Doubles> c) HWY_ATTR { return sine_of_cosine(c); }, view.cosine);
    view.log_cosine = hn::Log(d, rounded(view.cosine));
    // artanh(sinθ) = log((1 + sinθ) / cosθ).
    const auto stretch = hn::Sub(hn::Log(d, hn::Add(rounded(view.sine), all(d, 1))), view.log_cosine);
    const auto position = hn::Max(hn::Zero(d), hn::Mul(stretch, hn::Set(d, step)));
    // Counted from the row beyond the normal; the stencil begins one row before the view.
    view.row = hn::Min(hn::ConvertTo(di, position), hn::Set(di, kWarpedViews - 3));
    const auto t = hn::Sub(position, hn::Sub(hn::ConvertTo(d, view.row), all(d, 1)));
    const auto t1 = hn::Sub(t, all(d, 1));
    const auto t2 = hn::Sub(t, all(d, 2));
    const auto t3 = hn::Sub(t, all(d, 3));
    const auto outer = hn::Mul(t1, t2);
    const auto inner = hn::Mul(t, t3);
    view.weights = {hn::Mul(hn::Mul(outer, t3), all(d, -1.0 / 6)), hn::Mul(hn::Mul(inner, t2), all(d, 0.5)),
                    hn::Mul(hn::Mul(inner, t1), all(d, -0.5)), hn::Mul(hn::Mul(outer, t), all(d, 1.0 / 6))};
    return view;
}

/// x^(-2/3) for 1 ≤ x < 1000 or so: Newton's method for r⁻³ = x², from a third of the exponent.
HWY_INLINE V<Floats> power_minus_two_thirds(V<Floats> x) {
    const Floats d;
    const hn::RebindToSigned<Floats> di;
    // The bits of a float are about its logarithm: those of r are k - ⅔ those of x, with k found by least error.
    const auto bits = hn::ConvertTo(d, hn::BitCast(di, x));
    auto r = hn::BitCast(d, hn::ConvertTo(di, hn::MulAdd(bits, all(d, -2.0 / 3), all(d, 1.77491e9))));
    const auto square = hn::Mul(x, x);
    for (int i = 0; i < 3; ++i) {
        const auto cube = hn::Mul(hn::Mul(r, r), r);
        r = hn::Mul(hn::Mul(r, all(d, 1.0 / 3)), hn::NegMulAdd(square, cube, all(d, 4)));
    }
    return r;
}

/// The narrowness w / (1 + w^1.5)^(2/3) of the width w = 5 α cos^0.4 θ_o, of which lobe_warp() makes its warp. A
/// float's rounding of it is one of the warp, which all that is warped shares.
HWY_INLINE V<Floats> narrowness_in_lanes(double alpha, V<Floats> log_cosine) {
    const Floats d;
    const auto width = hn::Mul(all(d, 5 * alpha), hn::Exp(d, hn::Mul(all(d, 0.4), log_cosine)));
    return hn::Mul(width, power_minus_two_thirds(hn::MulAdd(width, hn::Sqrt(width), all(d, 1))));
}

/// As Warp's constructor, with one division for all quotients.
HWY_INLINE WarpLanes<Doubles> warp_in_lanes(V<Doubles> sine, V<Doubles> cosine, V<Doubles> narrowness) {
    const Doubles d;
    const auto one = all(d, 1);
    const auto r = hn::Sub(one, narrowness);
    const auto scale = hn::MulAdd(r, r, one);
    const auto reach = hn::Mul(narrowness, hn::Add(one, r));
    // The horizon's middle times `reach`.
    const auto tall = hn::Mul(scale, cosine);
    const auto wide = hn::Mul(reach, sine);
    const auto length = hn::Sqrt(hn::MulAdd(tall, tall, hn::Mul(wide, wide)));
    const auto both = hn::Mul(scale, reach);
    const auto inverse = hn::Div(one, hn::Mul(both, length));
    const auto over_both = hn::Mul(inverse, length);
    const auto over_scale = hn::Mul(over_both, reach);
    const auto over_length = hn::Mul(inverse, both);
    const auto speed = hn::Mul(hn::Add(r, r), over_scale);
    const auto horizon_z = hn::Mul(tall, over_length);
    return {sine,
            cosine,
            speed,
            hn::Mul(hn::Mul(narrowness, narrowness), over_scale),
            hn::Mul(hn::Mul(over_both, scale), scale),
            hn::Mul(wide, over_length),
            horizon_z,
            hn::Neg(hn::Mul(speed, horizon_z)),
            hn::Mul(reach, over_length)};
}

/// The warps of a vector's views.
struct WarpPair {
    WarpLanes<Doubles> low, high;
};

/// sine, cosine: of the fitted view.
HWY_INLINE WarpPair warps_in_lanes(double alpha, V<Floats> log_cosine, const DoublePair& sine,
                                   const DoublePair& cosine) {
    const Doubles d;
    const HalfFloats half;
    const auto narrowness = narrowness_in_lanes(alpha, log_cosine);
    return {warp_in_lanes(sine.low, cosine.low, hn::PromoteTo(d, hn::LowerHalf(half, narrowness))),
            warp_in_lanes(sine.high, cosine.high, hn::PromoteTo(d, hn::UpperHalf(half, narrowness)))};
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
