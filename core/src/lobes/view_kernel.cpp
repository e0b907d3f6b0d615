// SPDX-License-Identifier: MIT
#include "lobes/view_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lobes/view_kernel.cpp"
#include <hwy/foreach_target.h>
// Highway's vocabulary, and what is compiled once per instruction set, come after it.
#include <hwy/highway.h>

#include "lobes/view_lanes-inl.h"
#include "lobes/views-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

constexpr std::size_t kLanes = kLaneCount<Floats>;
static_assert(kViewLanes % kLanes == 0);

HWY_INLINE void store_pair(const DoublePair& pair, double* to) {
    hn::StoreU(pair.low, Doubles(), to);
    hn::StoreU(pair.high, Doubles(), to + kLaneCount<Doubles>);
}

void find_views_in_lanes(const double* cos_theta_o, std::size_t count, const ViewOutput& out) {
    const Floats d;
    for (std::size_t i = 0; i < count; i += kLanes) {
        const DoublePair given = Neighbours(i).pair(cos_theta_o);
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

HWY_INLINE void store_warp(const WarpLanes<Doubles>& warp, std::size_t i, const WarpOutput& out) {
    const Doubles d;
    hn::StoreU(warp.speed, d, out.speed + i);
    hn::StoreU(warp.one_minus_speed, d, out.one_minus_speed + i);
    hn::StoreU(warp.gamma, d, out.gamma + i);
    hn::StoreU(warp.horizon_x, d, out.horizon_x + i);
    hn::StoreU(warp.horizon_z, d, out.horizon_z + i);
    hn::StoreU(warp.horizon_height, d, out.horizon_height + i);
    hn::StoreU(warp.horizon_sine, d, out.horizon_sine + i);
}

void warp_views_in_lanes(double alpha, const ViewOutput& views, std::size_t count, const WarpOutput& out) {
    for (std::size_t i = 0; i < count; i += kLanes) {
        const Neighbours from(i);
        const WarpPair warps = warps_in_lanes(alpha, hn::LoadU(Floats(), views.log_cosine + i),
                                              from.pair(views.fitted_sine), from.pair(views.fitted_cosine));
        store_warp(warps.low, i, out);
        store_warp(warps.high, i + kLaneCount<Doubles>, out);
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
