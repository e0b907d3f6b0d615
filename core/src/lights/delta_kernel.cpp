// SPDX-License-Identifier: MIT
#include "lights/delta_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "lights/delta_kernel.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/highway.h>

#include <limits>

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

static_assert(kDeltaLanes % kLaneCount<Floats> == 0 && kDeltaLanes % kLaneCount<Doubles> == 0);

/// Vectors from a point to sources, and their squared lengths.
struct Way {
    V<Doubles> x, y, z, w, square;
};

/// The vectors to sources i, i + 1, … In double, since a source may be near and both far from the world's origin.
HWY_INLINE Way way_to(const DeltaArrays& deltas, std::size_t i, const Vec3d& position) {
    const Doubles d;
    Way way;
    way.w = hn::LoadU(d, deltas.w + i);
    way.x = hn::NegMulAdd(way.w, all(d, position.x), hn::LoadU(d, deltas.x + i));
    way.y = hn::NegMulAdd(way.w, all(d, position.y), hn::LoadU(d, deltas.y + i));
    way.z = hn::NegMulAdd(way.w, all(d, position.z), hn::LoadU(d, deltas.z + i));
    way.square = hn::MulAdd(way.x, way.x, hn::MulAdd(way.y, way.y, hn::Mul(way.z, way.z)));
    return way;
}

HWY_INLINE V<Doubles> along(const Vec3d& axis, const Way& way) {
    const Doubles d;
    return hn::MulAdd(all(d, axis.x), way.x, hn::MulAdd(all(d, axis.y), way.y, hn::Mul(all(d, axis.z), way.z)));
}

void see(const DeltaArrays& deltas, const ShadingFrame& frame, double least_distance, const DeltaViewArrays& views) {
    const Doubles d;
    for (std::size_t i = 0; i < deltas.count; i += kLaneCount<Doubles>) {
        const Way way = way_to(deltas, i, frame.origin);
        const auto distance = hn::Sqrt(way.square);
        const auto height = along(frame.z, way);
        const auto seen =
            hn::And(hn::Gt(height, hn::Zero(d)), hn::Gt(distance, hn::Mul(way.w, all(d, least_distance))));
        const auto scale = hn::IfThenElseZero(seen, hn::Div(all(d, 1), distance));
        hn::StoreU(hn::IfThenElseZero(seen, hn::Mul(along(frame.x, way), scale)), d, views.x + i);
        hn::StoreU(hn::IfThenElseZero(seen, hn::Mul(along(frame.y, way), scale)), d, views.y + i);
        hn::StoreU(hn::IfThenElseZero(seen, hn::Mul(height, scale)), d, views.z + i);
        hn::StoreU(hn::Mul(scale, scale), d, views.irradiance + i);
    }
}

double nearest_square(const DeltaArrays& deltas, const Vec3d& position) {
    const Doubles d;
    const auto infinity = all(d, std::numeric_limits<double>::infinity());
    auto least = infinity;
    for (std::size_t i = 0; i < deltas.count; i += kLaneCount<Doubles>) {
        const Way way = way_to(deltas, i, position);
        least = hn::Min(least, hn::IfThenElse(hn::Gt(way.w, hn::Zero(d)), way.square, infinity));
    }
    return hn::GetLane(hn::MinOfLanes(d, least));
}

Rgb sum_in_lanes(const float* values, const ColorArrays& weights, std::size_t count) {
    const Floats d;
    auto r = hn::Zero(d);
    auto g = hn::Zero(d);
    auto b = hn::Zero(d);
    for (std::size_t i = 0; i < count; i += kLaneCount<Floats>) {
        const auto value = hn::LoadU(d, values + i);
        r = hn::MulAdd(value, hn::LoadU(d, weights.r + i), r);
        g = hn::MulAdd(value, hn::LoadU(d, weights.g + i), g);
        b = hn::MulAdd(value, hn::LoadU(d, weights.b + i), b);
    }
    return {hn::GetLane(hn::SumOfLanes(d, r)), hn::GetLane(hn::SumOfLanes(d, g)), hn::GetLane(hn::SumOfLanes(d, b))};
}

void add_in_lanes(const float* values, const ColorArrays& colors, const Rgb& weight, std::size_t count, float* sums) {
    const Floats d;
    for (std::size_t i = 0; i < count; i += kLaneCount<Floats>) {
        auto color = hn::Mul(hn::Set(d, weight.x), hn::LoadU(d, colors.r + i));
        color = hn::MulAdd(hn::Set(d, weight.y), hn::LoadU(d, colors.g + i), color);
        color = hn::MulAdd(hn::Set(d, weight.z), hn::LoadU(d, colors.b + i), color);
        hn::StoreU(hn::MulAdd(hn::LoadU(d, values + i), color, hn::LoadU(d, sums + i)), d, sums + i);
    }
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(see);
HWY_EXPORT(nearest_square);
HWY_EXPORT(sum_in_lanes);
HWY_EXPORT(add_in_lanes);

void see_deltas(const DeltaArrays& deltas, const ShadingFrame& frame, double least_distance,
                const DeltaViewArrays& views) {
    HWY_DYNAMIC_DISPATCH(see)(deltas, frame, least_distance, views);
}

double nearest_delta_square(const DeltaArrays& deltas, const Vec3d& position) {
    return HWY_DYNAMIC_DISPATCH(nearest_square)(deltas, position);
}

Rgb weighted_sum(const float* values, const ColorArrays& weights, std::size_t count) {
    return HWY_DYNAMIC_DISPATCH(sum_in_lanes)(values, weights, count);
}

void add_weighted(const float* values, const ColorArrays& colors, const Rgb& weight, std::size_t count, float* sums) {
    HWY_DYNAMIC_DISPATCH(add_in_lanes)(values, colors, weight, count, sums);
}

}  // namespace shlight
#endif
