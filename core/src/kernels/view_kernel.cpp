// SPDX-License-Identifier: MIT
#include "kernels/view_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/view_kernel.cpp"
#include <hwy/foreach_target.h>
// Highway's vocabulary, and what is compiled once per instruction set, come after it.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <hwy/contrib/math/math-inl.h>

#include "kernels/lanes-inl.h"
#include "kernels/view_lanes-inl.h"
#include "shlight/warped_fit.h"
#include "warped_row.h"

HWY_BEFORE_NAMESPACE();
namespace shlight {
namespace HWY_NAMESPACE {
namespace {

constexpr std::size_t kViewLanes = kLaneCount<Doubles>;

/// What a vector of lanes reads and writes; at the end of the batch by way of buffers that are full.
template <class Work>
HWY_INLINE void in_vectors(std::span<const double> cos_theta_o, const Work& work) {
    const Doubles d;
    std::size_t first = 0;
    for (; first + kViewLanes <= cos_theta_o.size(); first += kViewLanes) {
        work(first, kViewLanes, hn::LoadU(d, cos_theta_o.data() + first));
    }
    if (const std::size_t rest = cos_theta_o.size() - first; rest > 0) {
        alignas(64) std::array<double, kViewLanes> padded;
        std::fill(std::copy_n(cos_theta_o.data() + first, rest, padded.begin()), padded.end(), 1.0);
        work(first, rest, hn::Load(d, padded.data()));
    }
}

HWY_INLINE V<Doubles> fitted_cosine(V<Doubles> cos_theta_o) {
    const Doubles d;
    return hn::Min(hn::Max(cos_theta_o, all(d, kLeastFittedCosine)), all(d, 1));
}

HWY_INLINE V<Doubles> sine_of(V<Doubles> cosine) {
    const Doubles d;
    const auto one = all(d, 1);
    return hn::Sqrt(hn::Mul(hn::Sub(one, cosine), hn::Add(one, cosine)));
}

void find_views_in_lanes(std::span<const double> cos_theta_o, std::uint32_t* rows, float* weights) {
    const HalfFloats d;
    const hn::RebindToSigned<HalfFloats> di;
    const float step = static_cast<float>((kWarpedViews - 1) / std::acosh(1 / kLeastFittedCosine));
    in_vectors(cos_theta_o, [&](std::size_t first, std::size_t count, V<Doubles> given) HWY_ATTR {
        const auto cosine = fitted_cosine(given);
        // artanh(sinθ) = log((1 + sinθ) / cosθ).
        const auto stretch = hn::Div(hn::Add(all(Doubles(), 1), sine_of(cosine)), cosine);
        const auto position = hn::Mul(hn::Log(d, hn::DemoteTo(d, stretch)), hn::Set(d, step));
        // Counted from the row beyond the normal; the stencil begins one row before the view.
        auto row = hn::Min(hn::ConvertTo(di, position), hn::Set(di, kWarpedViews - 3));
        const auto t = hn::Sub(position, hn::Sub(hn::ConvertTo(d, row), all(d, 1)));
        const auto t1 = hn::Sub(t, all(d, 1));
        const auto t2 = hn::Sub(t, all(d, 2));
        const auto t3 = hn::Sub(t, all(d, 3));
        const auto outer = hn::Mul(t1, t2);
        const auto inner = hn::Mul(t, t3);
        alignas(64) std::array<float, 4 * kViewLanes> buffer;
        hn::StoreInterleaved4(hn::Mul(hn::Mul(outer, t3), all(d, -1.0 / 6)), hn::Mul(hn::Mul(inner, t2), all(d, 0.5)),
                              hn::Mul(hn::Mul(inner, t1), all(d, -0.5)), hn::Mul(hn::Mul(outer, t), all(d, 1.0 / 6)), d,
                              buffer.data());
        std::copy_n(buffer.begin(), 4 * count, weights + 4 * first);
        store_some(hn::RebindToUnsigned<HalfFloats>(), hn::BitCast(hn::RebindToUnsigned<HalfFloats>(), row), count,
                   rows + first);
    });
}

void warp_views_in_lanes(double alpha, std::span<const double> cos_theta_o, const WarpOutput& out) {
    const Doubles d;
    const HalfFloats df;
    const auto one = all(d, 1);
    in_vectors(cos_theta_o, [&](std::size_t first, std::size_t count, V<Doubles> given) HWY_ATTR {
        const auto cosine = fitted_cosine(given);
        const auto sine = sine_of(cosine);
        // The narrowness w / (1 + w^1.5)^(2/3) of the width w = 5 α cos^0.4 θ_o. A float's rounding of it is one of the
        // warp, which all that is warped shares.
        const auto width = hn::Mul(all(df, 5 * alpha),
                                   hn::Exp(df, hn::Mul(all(df, 0.4), hn::Log(df, hn::DemoteTo(df, cosine)))));
        const auto saturation = hn::Log(df, hn::MulAdd(width, hn::Sqrt(width), all(df, 1)));
        const auto narrowness =
            hn::PromoteTo(d, hn::Mul(width, hn::Exp(df, hn::Mul(all(df, -2.0 / 3), saturation))));
        // As Warp's constructor.
        const auto r = hn::Sub(one, narrowness);
        const auto scale = hn::MulAdd(r, r, one);
        const auto over_scale = hn::Div(one, scale);
        const auto speed = hn::Mul(hn::Add(r, r), over_scale);
        const auto gamma = hn::Div(scale, hn::Mul(narrowness, hn::Add(one, r)));
        const auto tall = hn::Mul(gamma, cosine);
        const auto over_length = hn::Div(one, hn::Sqrt(hn::MulAdd(tall, tall, hn::Mul(sine, sine))));
        const auto horizon_z = hn::Mul(tall, over_length);
        const auto store = [&](V<Doubles> value, double* to) HWY_ATTR { store_some(d, value, count, to + first); };
        store(sine, out.sin_tilt);
        store(cosine, out.cos_tilt);
        store(speed, out.speed);
        store(hn::Mul(hn::Mul(narrowness, narrowness), over_scale), out.one_minus_speed);
        store(gamma, out.gamma);
        store(hn::Mul(sine, over_length), out.horizon_x);
        store(horizon_z, out.horizon_z);
        store(hn::Neg(hn::Mul(speed, horizon_z)), out.horizon_height);
        store(over_length, out.horizon_sine);
    });
}

void interpolate_in_lanes(const float* table, std::size_t width, const std::uint32_t* rows, const float* weights,
                          std::span<const std::uint32_t> views, float* out, std::size_t stride) {
    const Floats d;
    for (const std::uint32_t view : views) {
        const float* from = table + rows[view] * width;
        const float* w = weights + std::size_t{4} * view;
        float* to = out + view * stride;
        const auto w0 = hn::Set(d, w[0]);
        const auto w1 = hn::Set(d, w[1]);
        const auto w2 = hn::Set(d, w[2]);
        const auto w3 = hn::Set(d, w[3]);
        for (std::size_t i = 0; i < width; i += kLaneCount<Floats>) {
            auto sum = hn::Mul(w0, hn::Load(d, from + i));
            sum = hn::MulAdd(w1, hn::Load(d, from + width + i), sum);
            sum = hn::MulAdd(w2, hn::Load(d, from + 2 * width + i), sum);
            sum = hn::MulAdd(w3, hn::Load(d, from + 3 * width + i), sum);
            hn::Store(sum, d, to + i);
        }
    }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace shlight
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(find_views_in_lanes);
HWY_EXPORT(warp_views_in_lanes);
HWY_EXPORT(interpolate_in_lanes);

void find_views(std::span<const double> cos_theta_o, std::uint32_t* rows, float* weights) {
    HWY_DYNAMIC_DISPATCH(find_views_in_lanes)(cos_theta_o, rows, weights);
}

void warp_views(double alpha, std::span<const double> cos_theta_o, const WarpOutput& out) {
    HWY_DYNAMIC_DISPATCH(warp_views_in_lanes)(alpha, cos_theta_o, out);
}

void interpolate_views(const float* table, std::size_t width, const std::uint32_t* rows, const float* weights,
                       std::span<const std::uint32_t> views, float* out, std::size_t stride) {
    HWY_DYNAMIC_DISPATCH(interpolate_in_lanes)(table, width, rows, weights, views, out, stride);
}

}  // namespace shlight
#endif
