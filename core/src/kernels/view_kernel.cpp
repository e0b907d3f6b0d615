// SPDX-License-Identifier: MIT
#include "kernels/view_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/view_kernel.cpp"
#include <hwy/foreach_target.h>
// Highway's vocabulary, and what is compiled once per instruction set, come after it.
#include <hwy/highway.h>

#include <cmath>

#include <hwy/contrib/math/math-inl.h>

#include "kernels/lanes-inl.h"
#include "kernels/view_lanes-inl.h"
#include "shlight/warped_fit.h"
#include "warped_row.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

constexpr std::size_t kLanes = kLaneCount<Floats>;
static_assert(kViewLanes % kLanes == 0);

HWY_INLINE DoublePair load_pair(const double* from) {
    return Neighbours(0).pair(from);
}
HWY_INLINE void store_pair(const DoublePair& pair, double* to) {
    hn::StoreU(pair.low, Doubles(), to);
    hn::StoreU(pair.high, Doubles(), to + kLaneCount<Doubles>);
}
template <class Function>
HWY_INLINE DoublePair each(const Function& function, const DoublePair& a) {
    return {function(a.low), function(a.high)};
}
template <class Function>
HWY_INLINE DoublePair each(const Function& function, const DoublePair& a, const DoublePair& b) {
    return {function(a.low, b.low), function(a.high, b.high)};
}

HWY_INLINE V<Doubles> sine_of(V<Doubles> cosine) {
    const auto one = all(Doubles(), 1);
    return hn::Sqrt(hn::Mul(hn::Sub(one, cosine), hn::Add(one, cosine)));
}

void find_views_in_lanes(const double* cos_theta_o, std::size_t count, const ViewOutput& out) {
    const Floats d;
    const hn::RebindToSigned<Floats> di;
    const hn::RebindToUnsigned<Floats> du;
    const auto step = static_cast<float>((kWarpedViews - 1) / std::acosh(1 / kLeastFittedCosine));
    for (std::size_t i = 0; i < count; i += kLanes) {
        const DoublePair given = load_pair(cos_theta_o + i);
        const DoublePair cosine =
            each([](V<Doubles> c)
                     HWY_ATTR { return hn::Min(hn::Max(c, all(Doubles(), kLeastFittedCosine)), all(Doubles(), 1)); },
                 given);
        const DoublePair sine = each([](V<Doubles> c) HWY_ATTR { return sine_of(c); }, cosine);
        store_pair(each([](V<Doubles> c) HWY_ATTR { return sine_of(c); }, given), out.sine + i);
        store_pair(sine, out.fitted_sine + i);
        store_pair(cosine, out.fitted_cosine + i);
        const auto log_cosine = hn::Log(d, rounded(cosine));
        hn::StoreU(log_cosine, d, out.log_cosine + i);
        // artanh(sinθ) = log((1 + sinθ) / cosθ).
        const auto stretch = hn::Sub(hn::Log(d, hn::Add(rounded(sine), all(d, 1))), log_cosine);
        const auto position = hn::Max(hn::Zero(d), hn::Mul(stretch, hn::Set(d, step)));
        // Counted from the row beyond the normal; the stencil begins one row before the view.
        const auto row = hn::Min(hn::ConvertTo(di, position), hn::Set(di, kWarpedViews - 3));
        hn::StoreU(hn::BitCast(du, row), du, out.row + i);
        const auto t = hn::Sub(position, hn::Sub(hn::ConvertTo(d, row), all(d, 1)));
        const auto t1 = hn::Sub(t, all(d, 1));
        const auto t2 = hn::Sub(t, all(d, 2));
        const auto t3 = hn::Sub(t, all(d, 3));
        const auto outer = hn::Mul(t1, t2);
        const auto inner = hn::Mul(t, t3);
        hn::StoreInterleaved4(hn::Mul(hn::Mul(outer, t3), all(d, -1.0 / 6)), hn::Mul(hn::Mul(inner, t2), all(d, 0.5)),
                              hn::Mul(hn::Mul(inner, t1), all(d, -0.5)), hn::Mul(hn::Mul(outer, t), all(d, 1.0 / 6)), d,
                              out.weights + 4 * i);
    }
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

/// As Warp's constructor.
HWY_INLINE void write_warps(V<Doubles> sine, V<Doubles> cosine, V<Doubles> narrowness, std::size_t i,
                            const WarpOutput& out) {
    const Doubles d;
    const auto one = all(d, 1);
    const auto r = hn::Sub(one, narrowness);
    const auto scale = hn::MulAdd(r, r, one);
    const auto reach = hn::Mul(narrowness, hn::Add(one, r));
    const auto inverse = hn::Div(one, hn::Mul(scale, reach));
    const auto over_scale = hn::Mul(inverse, reach);
    const auto gamma = hn::Mul(hn::Mul(inverse, scale), scale);
    const auto speed = hn::Mul(hn::Add(r, r), over_scale);
    const auto tall = hn::Mul(gamma, cosine);
    const auto over_length = hn::Div(one, hn::Sqrt(hn::MulAdd(tall, tall, hn::Mul(sine, sine))));
    const auto horizon_z = hn::Mul(tall, over_length);
    hn::StoreU(speed, d, out.speed + i);
    hn::StoreU(hn::Mul(hn::Mul(narrowness, narrowness), over_scale), d, out.one_minus_speed + i);
    hn::StoreU(gamma, d, out.gamma + i);
    hn::StoreU(hn::Mul(sine, over_length), d, out.horizon_x + i);
    hn::StoreU(horizon_z, d, out.horizon_z + i);
    hn::StoreU(hn::Neg(hn::Mul(speed, horizon_z)), d, out.horizon_height + i);
    hn::StoreU(over_length, d, out.horizon_sine + i);
}

void warp_views_in_lanes(double alpha, const ViewOutput& views, std::size_t count, const WarpOutput& out) {
    const Floats d;
    const Doubles wide;
    const HalfFloats half;
    for (std::size_t i = 0; i < count; i += kLanes) {
        // The narrowness w / (1 + w^1.5)^(2/3) of the width w = 5 α cos^0.4 θ_o. A float's rounding of it is one of the
        // warp, which all that is warped shares.
        const auto log_cosine = hn::LoadU(d, views.log_cosine + i);
        const auto width = hn::Mul(all(d, 5 * alpha), hn::Exp(d, hn::Mul(all(d, 0.4), log_cosine)));
        const auto saturation = power_minus_two_thirds(hn::MulAdd(width, hn::Sqrt(width), all(d, 1)));
        const auto narrowness = hn::Mul(width, saturation);
        const DoublePair sine = load_pair(views.fitted_sine + i);
        const DoublePair cosine = load_pair(views.fitted_cosine + i);
        write_warps(sine.low, cosine.low, hn::PromoteTo(wide, hn::LowerHalf(half, narrowness)), i, out);
        write_warps(sine.high, cosine.high, hn::PromoteTo(wide, hn::UpperHalf(half, narrowness)),
                    i + kLaneCount<Doubles>, out);
    }
}

/// kWidth: of the table, so that the loop over it unrolls; or 0.
template <std::size_t kWidth>
void interpolate(const float* table, std::size_t any_width, const std::uint32_t* rows, const float* weights,
                 std::span<const std::uint32_t> views, float* out, std::size_t stride) {
    const Floats d;
    const std::size_t width = kWidth == 0 ? any_width : kWidth;
    for (const std::uint32_t view : views) {
        const float* from = table + rows[view] * width;
        const float* w = weights + std::size_t{4} * view;
        float* to = out + view * stride;
        const auto w0 = hn::Set(d, w[0]);
        const auto w1 = hn::Set(d, w[1]);
        const auto w2 = hn::Set(d, w[2]);
        const auto w3 = hn::Set(d, w[3]);
        for (std::size_t i = 0; i < width; i += kLanes) {
            auto sum = hn::Mul(w0, hn::Load(d, from + i));
            sum = hn::MulAdd(w1, hn::Load(d, from + width + i), sum);
            sum = hn::MulAdd(w2, hn::Load(d, from + 2 * width + i), sum);
            sum = hn::MulAdd(w3, hn::Load(d, from + 3 * width + i), sum);
            hn::Store(sum, d, to + i);
        }
    }
}

void interpolate_in_lanes(const float* table, std::size_t width, const std::uint32_t* rows, const float* weights,
                          std::span<const std::uint32_t> views, float* out, std::size_t stride) {
    // Orders up to 4, 6, 8 and 16, and heads.
    switch (width) {
        case 16:
            return interpolate<16>(table, width, rows, weights, views, out, stride);
        case 32:
            return interpolate<32>(table, width, rows, weights, views, out, stride);
        case 48:
            return interpolate<48>(table, width, rows, weights, views, out, stride);
        case 144:
            return interpolate<144>(table, width, rows, weights, views, out, stride);
        default:
            return interpolate<0>(table, width, rows, weights, views, out, stride);
    }
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(find_views_in_lanes);
HWY_EXPORT(warp_views_in_lanes);
HWY_EXPORT(interpolate_in_lanes);

void find_views(const double* cos_theta_o, std::size_t count, const ViewOutput& out) {
    HWY_DYNAMIC_DISPATCH(find_views_in_lanes)(cos_theta_o, count, out);
}

void warp_views(double alpha, const ViewOutput& views, std::size_t count, const WarpOutput& out) {
    HWY_DYNAMIC_DISPATCH(warp_views_in_lanes)(alpha, views, count, out);
}

void interpolate_views(const float* table, std::size_t width, const std::uint32_t* rows, const float* weights,
                       std::span<const std::uint32_t> views, float* out, std::size_t stride) {
    HWY_DYNAMIC_DISPATCH(interpolate_in_lanes)(table, width, rows, weights, views, out, stride);
}

}  // namespace shlight
#endif
