// SPDX-License-Identifier: MIT
#include "environment/map_lookup.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "environment/map_lookup.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include <cmath>
#include <cstdint>
#include <numbers>

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

static_assert(kLookupLanes % kLaneCount<Floats> == 0);

using Integers = hn::RebindToSigned<Floats>;

/// As texel_of(), of a picture of size 1 × 1.
struct Place {
    V<Floats> x, y;
};

HWY_INLINE Place place_in_lanes(V<Floats> x, V<Floats> y, V<Floats> z) {
    const Floats d;
    const auto across = hn::Sqrt(hn::MulAdd(x, x, hn::Mul(y, y)));
    const auto longitude = arctangent(d, y, x);
    const auto latitude = arctangent(d, z, across);
    return {hn::NegMulAdd(longitude, all(d, 1 / (2 * std::numbers::pi)), all(d, 0.5)),
            hn::NegMulAdd(latitude, all(d, 1 / std::numbers::pi), all(d, 0.5))};
}

/// Index of a column that may be one width off.
HWY_INLINE V<Integers> wrapped(V<Integers> column, V<Integers> width) {
    const Integers d;
    column = hn::Add(column, hn::IfThenElseZero(hn::Lt(column, hn::Zero(d)), width));
    return hn::Sub(column, hn::IfThenElseZero(hn::Gt(column, hn::Sub(width, hn::Set(d, 1))), width));
}

HWY_INLINE V<Integers> clamped(V<Integers> row, V<Integers> last) {
    const Integers d;
    return hn::Min(hn::Max(row, hn::Zero(d)), last);
}

/// Four texels about a place and their shares.
class Neighbourhood {
  public:
    /// first: of the picture's pixels.
    HWY_INLINE Neighbourhood(const Place& place, V<Integers> width, V<Integers> height, V<Integers> first) {
        const Floats d;
        const Integers di;
        const auto half = all(d, 0.5);
        const auto one = hn::Set(di, 1);
        const auto last = hn::Sub(height, one);
        const auto x = hn::MulSub(place.x, hn::ConvertTo(d, width), half);
        const auto left = hn::Floor(x);
        const auto y =
            hn::Min(hn::Max(hn::MulSub(place.y, hn::ConvertTo(d, height), half), hn::Zero(d)), hn::ConvertTo(d, last));
        const auto above = hn::Floor(y);
        across_ = hn::Sub(x, left);
        down_ = hn::Sub(y, above);
        const auto column = wrapped(hn::ConvertTo(di, left), width);
        const auto next = wrapped(hn::Add(column, one), width);
        const auto row = clamped(hn::ConvertTo(di, above), last);
        const auto upper = hn::Add(first, hn::Mul(row, width));
        const auto lower = hn::Add(first, hn::Mul(clamped(hn::Add(row, one), last), width));
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
HWY_INLINE V<Floats> density_in_lanes(const RadianceSampler& sampler, const Place& place, V<Integers> width,
                                      V<Integers> height) {
    const Floats d;
    const Integers di;
    const auto half = all(d, 0.5);
    const auto y = hn::MulAdd(place.y, hn::ConvertTo(d, height), half);
    const auto x = hn::MulSub(place.x, hn::ConvertTo(d, width), half);
    const auto row = clamped(hn::ConvertTo(di, hn::Floor(y)), height);
    const auto column = wrapped(hn::ConvertTo(di, hn::Floor(x)), width);
    const auto cell = hn::Add(hn::Mul(row, width), column);
    const auto up_to = hn::GatherIndex(d, sampler.cells(), cell);
    const auto is_first = hn::Eq(column, hn::Zero(di));
    const auto before =
        hn::GatherIndex(d, sampler.cells(), hn::Sub(cell, hn::IfThenZeroElse(is_first, hn::Set(di, 1))));
    const auto share = hn::Sub(up_to, hn::IfThenZeroElse(hn::RebindMask(d, is_first), before));
    return hn::Mul(hn::GatherIndex(d, sampler.row_densities(), row), share);
}

HWY_INLINE Place load_place(const MapDirections& directions, std::size_t i) {
    const Floats d;
    return place_in_lanes(hn::LoadU(d, directions.x + i), hn::LoadU(d, directions.y + i),
                          hn::LoadU(d, directions.z + i));
}

void look_up(const EnvironmentMap& map, const MapDirections& directions, std::size_t count, const MapValues& values) {
    const Floats d;
    const Integers di;
    const auto width = hn::Set(di, map.picture.width());
    const auto height = hn::Set(di, map.picture.height());
    const float* whole = &map.picture.pixels()->x;
    const float* smooth = &map.smooth.pixels()->x;
    for (std::size_t i = 0; i < count; i += kLaneCount<Floats>) {
        const Place place = load_place(directions, i);
        const Neighbourhood about(place, width, height, hn::Zero(di));
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const auto without = about.channel(smooth + channel);
            hn::StoreU(without, d, values.smooth[channel] + i);
            hn::StoreU(hn::Sub(about.channel(whole + channel), without), d, values.spots[channel] + i);
        }
        hn::StoreU(density_in_lanes(map.sampler, place, width, height), d, values.density + i);
    }
}

HWY_INLINE Neighbourhood on_level(const RadiancePyramid& pyramid, V<Floats> level, const Place& place) {
    const Integers di;
    static_assert(sizeof(RadiancePyramid::Level) == 3 * sizeof(int));
    const int* first = &pyramid.levels()[0].width;
    const auto at = hn::Mul(hn::ConvertTo(di, level), hn::Set(di, 3));
    return {place, hn::GatherIndex(di, first, at), hn::GatherIndex(di, first + 1, at),
            hn::GatherIndex(di, first + 2, at)};
}

void look_up_blurred(const RadiancePyramid& pyramid, const MapDirections& directions, const float* solid_angles,
                     std::size_t count, const std::array<float*, 3>& radiance) {
    const Floats d;
    const auto last = all(d, static_cast<double>(pyramid.levels().size() - 1));
    // At the equator of level 0.
    const double texel = 2 * std::numbers::pi / pyramid.width() * std::numbers::pi / pyramid.height();
    const auto offset = all(d, 0.5 * std::log2(texel));
    const float* channels = &pyramid.pixels()->x;
    for (std::size_t i = 0; i < count; i += kLaneCount<Floats>) {
        const auto wanted = hn::MulSub(all(d, 0.5), hn::Log2(d, hn::LoadU(d, solid_angles + i)), offset);
        const auto level = hn::Min(hn::Max(wanted, hn::Zero(d)), last);
        const auto finer = hn::Floor(level);
        const auto share = hn::Sub(level, finer);
        const Place place = load_place(directions, i);
        const Neighbourhood fine = on_level(pyramid, finer, place);
        const Neighbourhood coarse = on_level(pyramid, hn::Min(hn::Add(finer, all(d, 1)), last), place);
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const auto of_fine = fine.channel(channels + channel);
            const auto blurred = hn::MulAdd(share, hn::Sub(coarse.channel(channels + channel), of_fine), of_fine);
            hn::StoreU(blurred, d, radiance[channel] + i);
        }
    }
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(look_up);
HWY_EXPORT(look_up_blurred);

void look_up(const EnvironmentMap& map, const MapDirections& directions, std::size_t count, const MapValues& values) {
    HWY_DYNAMIC_DISPATCH(look_up)(map, directions, count, values);
}

void look_up_blurred(const RadiancePyramid& pyramid, const MapDirections& directions, const float* solid_angles,
                     std::size_t count, const std::array<float*, 3>& radiance) {
    HWY_DYNAMIC_DISPATCH(look_up_blurred)(pyramid, directions, solid_angles, count, radiance);
}

}  // namespace shlight
#endif
