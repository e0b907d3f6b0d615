// SPDX-License-Identifier: MIT
#include "lobes/view_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lobes/view_kernel.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/highway.h>

#include <array>
#include <cmath>

#include <hwy/contrib/math/math-inl.h>

#include "lobes/fit_table.h"
#include "regions/boost_lanes-inl.h"
#include "shlight/boosted_fit.h"
#include "simd/gather-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

template <class Function>
HWY_INLINE DoublePair each(const Function& function, const DoublePair& a) {
    return {function(a.low), function(a.high)};
}

HWY_INLINE V<Doubles> sine_of_cosine(V<Doubles> cosine) {
    const auto one = all(Doubles(), 1);
    return hn::Sqrt(hn::Mul(hn::Sub(one, cosine), hn::Add(one, cosine)));
}

/// The fitted view nearest to a view, and its place in a FitTable: the first of four rows, and four cubic weights.
struct ViewLanes {
    DoublePair cosine, sine;
    V<Floats> log_cosine;
    V<hn::RebindToSigned<Floats>> row;
    std::array<V<Floats>, 4> weights;
};

HWY_INLINE ViewLanes view_in_lanes(const DoublePair& cos_theta_o) {
    const Floats d;
    const hn::RebindToSigned<Floats> di;
    const auto step = static_cast<float>((kBoostedViews - 1) / std::acosh(1 / kLeastFittedCosine));
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
    // Row 0 is the view beyond the normal; the stencil begins one row before the view.
    view.row = hn::Min(hn::ConvertTo(di, position), hn::Set(di, kBoostedViews - 3));
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

/// x^(-2/3) for 1 ≤ x < 1000 or so, by Newton's method for r⁻³ = x² from an estimate by the exponent.
HWY_INLINE V<Floats> power_minus_two_thirds(V<Floats> x) {
    const Floats d;
    const hn::RebindToSigned<Floats> di;
    // A float's bits are nearly its logarithm: those of r are k - ⅔ those of x. The k used has the least error.
    const auto bits = hn::ConvertTo(d, hn::BitCast(di, x));
    auto r = hn::BitCast(d, hn::ConvertTo(di, hn::MulAdd(bits, all(d, -2.0 / 3), all(d, 1.77491e9))));
    const auto square = hn::Mul(x, x);
    for (int i = 0; i < 3; ++i) {
        const auto cube = hn::Mul(hn::Mul(r, r), r);
        r = hn::Mul(hn::Mul(r, all(d, 1.0 / 3)), hn::NegMulAdd(square, cube, all(d, 4)));
    }
    return r;
}

/// The narrowness w / (1 + w^1.5)^(2/3) of the width w = 5 α cos^0.4 θ_o, as in lobe_boost(). Rounding it to float does
/// no harm, because all that is boosted shares the rounded value.
HWY_INLINE V<Floats> narrowness_in_lanes(V<Floats> alpha, V<Floats> log_cosine) {
    const Floats d;
    const auto width = hn::Mul(hn::Mul(all(d, 5), alpha), hn::Exp(d, hn::Mul(all(d, 0.4), log_cosine)));
    return hn::Mul(width, power_minus_two_thirds(hn::MulAdd(width, hn::Sqrt(width), all(d, 1))));
}

/// Boost's constructor in lanes, with one division for all quotients.
HWY_INLINE BoostLanes boost_in_lanes(V<Doubles> sine, V<Doubles> cosine, V<Doubles> narrowness) {
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

/// sine, cosine: sinθ_o and cosθ_o of the fitted view.
HWY_INLINE BoostPair boosts_in_lanes(V<Floats> alpha, V<Floats> log_cosine, const DoublePair& sine,
                                     const DoublePair& cosine) {
    const Doubles d;
    const HalfFloats half;
    const auto narrowness = narrowness_in_lanes(alpha, log_cosine);
    return {boost_in_lanes(sine.low, cosine.low, hn::PromoteTo(d, hn::LowerHalf(half, narrowness))),
            boost_in_lanes(sine.high, cosine.high, hn::PromoteTo(d, hn::UpperHalf(half, narrowness)))};
}

constexpr std::size_t kLanes = kLaneCount<Floats>;
static_assert(kViewLanes % kLanes == 0);

HWY_INLINE void store_pair(const DoublePair& pair, double* to) {
    hn::StoreU(pair.low, Doubles(), to);
    hn::StoreU(pair.high, Doubles(), to + kLaneCount<Doubles>);
}

void find_views_in_lanes(const double* cos_theta_o, std::size_t count, const ViewOutput& out) {
    const Floats d;
    for (std::size_t i = 0; i < count; i += kLanes) {
        const DoublePair given = Contiguous(i).pair(cos_theta_o);
        const ViewLanes view = view_in_lanes(given);
        store_pair(each([](V<Doubles> c) HWY_ATTR { return sine_of_cosine(c); }, given), out.sine + i);
        store_pair(view.sine, out.fitted_sine + i);
        store_pair(view.cosine, out.fitted_cosine + i);
        hn::StoreU(view.log_cosine, d, out.log_cosine + i);
        const hn::RebindToUnsigned<Floats> du;
        hn::StoreU(hn::BitCast(du, view.row), du, out.row + i);
        hn::StoreInterleaved4(view.weights[0], view.weights[1], view.weights[2], view.weights[3], d,
                              out.weights + 4 * i);
    }
}

HWY_INLINE void store_boost(const BoostLanes& boost, std::size_t i, const BoostOutput& out) {
    const Doubles d;
    hn::StoreU(boost.speed, d, out.speed + i);
    hn::StoreU(boost.one_minus_speed, d, out.one_minus_speed + i);
    hn::StoreU(boost.gamma, d, out.gamma + i);
    hn::StoreU(boost.horizon_x, d, out.horizon_x + i);
    hn::StoreU(boost.horizon_z, d, out.horizon_z + i);
    hn::StoreU(boost.horizon_height, d, out.horizon_height + i);
    hn::StoreU(boost.horizon_sine, d, out.horizon_sine + i);
}

void boost_views_in_lanes(const float* alpha, const ViewOutput& views, std::size_t count, const BoostOutput& out) {
    for (std::size_t i = 0; i < count; i += kLanes) {
        const Contiguous from(i);
        const BoostPair boosts =
            boosts_in_lanes(hn::LoadU(Floats(), alpha + i), hn::LoadU(Floats(), views.log_cosine + i),
                            from.pair(views.fitted_sine), from.pair(views.fitted_cosine));
        store_boost(boosts.low, i, out);
        store_boost(boosts.high, i + kLaneCount<Doubles>, out);
    }
}

void interpolate_in_lanes(const TableNeighbours& neighbours, std::size_t row_size, std::size_t width,
                          const std::uint32_t* rows, const float* weights, std::span<const std::uint32_t> views,
                          float* out, std::size_t stride) {
    const Floats d;
    const std::size_t count = neighbours.count;
    constexpr float kWhole = 1;
    for (const std::uint32_t view : views) {
        const float* const* tables = neighbours.tables + (count == 1 ? 0 : count * view);
        const float* shares = count == 1 ? &kWhole : neighbours.weights + count * view;
        std::array<V<Floats>, 4> w;
        for (std::size_t row = 0; row < 4; ++row) {
            w[row] = hn::Set(d, weights[std::size_t{4} * view + row]);
        }
        float* to = out + view * stride;
        for (std::size_t k = 0; k < count; ++k) {
            const float* from = tables[k] + rows[view] * row_size;
            const auto share = hn::Set(d, shares[k]);
            for (std::size_t i = 0; i < width; i += kLanes) {
                auto sum = hn::Mul(w[0], hn::LoadU(d, from + i));
                for (std::size_t row = 1; row < 4; ++row) {
                    sum = hn::MulAdd(w[row], hn::LoadU(d, from + row * row_size + i), sum);
                }
                hn::Store(k == 0 ? hn::Mul(share, sum) : hn::MulAdd(share, sum, hn::Load(d, to + i)), d, to + i);
            }
        }
    }
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(find_views_in_lanes);
HWY_EXPORT(boost_views_in_lanes);
HWY_EXPORT(interpolate_in_lanes);

void find_views(const double* cos_theta_o, std::size_t count, const ViewOutput& out) {
    HWY_DYNAMIC_DISPATCH(find_views_in_lanes)(cos_theta_o, count, out);
}

void boost_views(const float* alpha, const ViewOutput& views, std::size_t count, const BoostOutput& out) {
    HWY_DYNAMIC_DISPATCH(boost_views_in_lanes)(alpha, views, count, out);
}

void interpolate_views(const TableNeighbours& neighbours, std::size_t row_size, std::size_t width,
                       const std::uint32_t* rows, const float* weights, std::span<const std::uint32_t> views,
                       float* out, std::size_t stride) {
    HWY_DYNAMIC_DISPATCH(interpolate_in_lanes)(neighbours, row_size, width, rows, weights, views, out, stride);
}

}  // namespace shlight
#endif
