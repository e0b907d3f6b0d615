// SPDX-License-Identifier: MIT
#include "environment/map_lookup.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "environment/map_lookup.cpp"
#include <hwy/foreach_target.h>
// Highway's vocabulary, and what is compiled once per instruction set, come after it.
#include <hwy/highway.h>

#include <cstdint>
#include <numbers>

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

static_assert(kLookupLanes % kLaneCount<Floats> == 0);

using Integers = hn::RebindToSigned<Floats>;

/// As texel_of().
struct Texel {
    V<Floats> x, y;
};

HWY_INLINE Texel texel_in_lanes(V<Floats> x, V<Floats> y, V<Floats> z, int width, int height) {
    const Floats d;
    const auto across = hn::Sqrt(hn::MulAdd(x, x, hn::Mul(y, y)));
    const auto longitude = arctangent(d, y, x);
    const auto latitude = arctangent(d, z, across);
    return {hn::NegMulAdd(longitude, all(d, width / (2 * std::numbers::pi)), all(d, 0.5 * width)),
            hn::NegMulAdd(latitude, all(d, height / std::numbers::pi), all(d, 0.5 * height))};
}

/// Index of a column that may be one width off.
HWY_INLINE V<Integers> wrapped(V<Integers> column, int width) {
    const Integers d;
    const auto all_columns = hn::Set(d, width);
    column = hn::Add(column, hn::IfThenElseZero(hn::Lt(column, hn::Zero(d)), all_columns));
    return hn::Sub(column, hn::IfThenElseZero(hn::Gt(column, hn::Sub(all_columns, hn::Set(d, 1))), all_columns));
}

HWY_INLINE V<Integers> clamped(V<Integers> row, int last) {
    const Integers d;
    return hn::Min(hn::Max(row, hn::Zero(d)), hn::Set(d, last));
}

/// Four texels about a place and their shares.
class Neighbourhood {
  public:
    HWY_INLINE Neighbourhood(const Texel& texel, int width, int height) {
        const Floats d;
        const Integers di;
        const auto half = all(d, 0.5);
        const auto x = hn::Sub(texel.x, half);
        const auto left = hn::Floor(x);
        const auto y = hn::Min(hn::Max(hn::Sub(texel.y, half), hn::Zero(d)), all(d, height - 1));
        const auto above = hn::Floor(y);
        across_ = hn::Sub(x, left);
        down_ = hn::Sub(y, above);
        const auto column = wrapped(hn::ConvertTo(di, left), width);
        const auto next = wrapped(hn::Add(column, hn::Set(di, 1)), width);
        const auto row = clamped(hn::ConvertTo(di, above), height - 1);
        const auto upper = hn::Mul(row, hn::Set(di, width));
        const auto lower = hn::Mul(clamped(hn::Add(row, hn::Set(di, 1)), height - 1), hn::Set(di, width));
        texels_ = {hn::Add(upper, column), hn::Add(upper, next), hn::Add(lower, column), hn::Add(lower, next)};
        for (auto& texel_index : texels_) {
            texel_index = hn::Mul(texel_index, hn::Set(di, 3));
        }
    }

    HWY_INLINE V<Floats> channel(const float* channels) const {
        const auto at = [&](std::size_t i) HWY_ATTR { return hn::GatherIndex(Floats(), channels, texels_[i]); };
        const auto upper = mix(at(0), at(1), across_);
        return mix(upper, mix(at(2), at(3), across_), down_);
    }

  private:
    static HWY_INLINE V<Floats> mix(V<Floats> a, V<Floats> b, V<Floats> share) {
        return hn::MulAdd(share, hn::Sub(b, a), a);
    }

    std::array<V<Integers>, 4> texels_;
    V<Floats> across_, down_;
};

/// As RadianceSampler::density().
HWY_INLINE V<Floats> density_in_lanes(const RadianceSampler& sampler, const Texel& texel, int width, int height) {
    const Floats d;
    const Integers di;
    const auto half = all(d, 0.5);
    const auto row = clamped(hn::ConvertTo(di, hn::Floor(hn::Add(texel.y, half))), height);
    const auto column = wrapped(hn::ConvertTo(di, hn::Floor(hn::Sub(texel.x, half))), width);
    const auto cell = hn::Add(hn::Mul(row, hn::Set(di, width)), column);
    const auto up_to = hn::GatherIndex(d, sampler.cells(), cell);
    const auto is_first = hn::Eq(column, hn::Zero(di));
    const auto before =
        hn::GatherIndex(d, sampler.cells(), hn::Sub(cell, hn::IfThenZeroElse(is_first, hn::Set(di, 1))));
    const auto share = hn::Sub(up_to, hn::IfThenZeroElse(hn::RebindMask(d, is_first), before));
    return hn::Mul(hn::GatherIndex(d, sampler.row_densities(), row), share);
}

void look_up(const EnvironmentMap& map, const MapDirections& directions, std::size_t count, const MapValues& values) {
    const Floats d;
    const int width = map.picture.width();
    const int height = map.picture.height();
    const float* whole = &map.picture.pixels()->x;
    const float* smooth = &map.smooth.pixels()->x;
    for (std::size_t i = 0; i < count; i += kLaneCount<Floats>) {
        const Texel texel = texel_in_lanes(hn::LoadU(d, directions.x + i), hn::LoadU(d, directions.y + i),
                                           hn::LoadU(d, directions.z + i), width, height);
        const Neighbourhood about(texel, width, height);
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const auto without = about.channel(smooth + channel);
            hn::StoreU(without, d, values.smooth[channel] + i);
            hn::StoreU(hn::Sub(about.channel(whole + channel), without), d, values.spots[channel] + i);
        }
        hn::StoreU(density_in_lanes(map.sampler, texel, width, height), d, values.density + i);
    }
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(look_up);

void look_up(const EnvironmentMap& map, const MapDirections& directions, std::size_t count, const MapValues& values) {
    HWY_DYNAMIC_DISPATCH(look_up)(map, directions, count, values);
}

}  // namespace shlight
#endif
