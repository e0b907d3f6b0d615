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

/// Result of texel_of() for a picture of size 1 × 1.
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

using Color = std::array<V<Floats>, 3>;

HWY_INLINE Color mixed(const Color& a, const Color& b, V<Floats> share) {
    return {hn::MulAdd(share, hn::Sub(b[0], a[0]), a[0]), hn::MulAdd(share, hn::Sub(b[1], a[1]), a[1]),
            hn::MulAdd(share, hn::Sub(b[2], a[2]), a[2])};
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

    HWY_INLINE Color mean(const Rgb* pixels) const {
        return mean_of([&](std::size_t i) HWY_ATTR { return texel(pixels, i); });
    }

    /// The mean of what the texels have below a limit of luminance.
    HWY_INLINE Color mean_below(const Rgb* pixels, double limit) const {
        const Floats d;
        // A texel as bright as the limit has nothing above it, however its luminance is rounded.
        const auto most = all(d, limit * (1 + 0x1p-20));
        return mean_of([&](std::size_t i) HWY_ATTR {
            const Color own = texel(pixels, i);
            const auto luminance =
                hn::MulAdd(own[0], all(d, kLuminance.x),
                           hn::MulAdd(own[1], all(d, kLuminance.y), hn::Mul(own[2], all(d, kLuminance.z))));
            const auto share = hn::IfThenElse(hn::Gt(luminance, most), hn::Div(most, luminance), hn::Set(d, 1.0F));
            return Color{hn::Mul(own[0], share), hn::Mul(own[1], share), hn::Mul(own[2], share)};
        });
    }

  private:
    HWY_INLINE Color texel(const Rgb* pixels, std::size_t i) const {
        const float* channels = &pixels->x;
        const Floats d;
        return {hn::GatherIndex(d, channels, texels_[i]), hn::GatherIndex(d, channels + 1, texels_[i]),
                hn::GatherIndex(d, channels + 2, texels_[i])};
    }
    template <class At>
    HWY_INLINE Color mean_of(const At& at) const {
        return mixed(mixed(at(0), at(1), across_), mixed(at(2), at(3), across_), down_);
    }

    std::array<V<Integers>, 4> texels_;
    V<Floats> across_, down_;
};

/// RadianceSampler::density() in lanes.
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

HWY_INLINE Neighbourhood on_picture(const LatLong& picture, const Place& place) {
    const Integers di;
    return {place, hn::Set(di, picture.width), hn::Set(di, picture.height), hn::Zero(di)};
}

void look_up(const EnvironmentMap& map, const MapDirections& directions, std::size_t count, const MapValues& values) {
    const Floats d;
    const Integers di;
    const LatLong& picture = *map.picture;
    for (std::size_t i = 0; i < count; i += kLaneCount<Floats>) {
        const Place place = load_place(directions, i);
        const Neighbourhood about = on_picture(picture, place);
        const Color smooth = about.mean_below(picture.pixels.data(), map.bright.limit);
        const Color whole = about.mean(picture.pixels.data());
        for (std::size_t channel = 0; channel < 3; ++channel) {
            hn::StoreU(smooth[channel], d, values.smooth[channel] + i);
            hn::StoreU(hn::Sub(whole[channel], smooth[channel]), d, values.spots[channel] + i);
        }
        const auto density =
            density_in_lanes(map.sampler, place, hn::Set(di, picture.width), hn::Set(di, picture.height));
        hn::StoreU(density, d, values.density + i);
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

void look_up_blurred(const EnvironmentMap& map, bool with_spots, const MapDirections& directions,
                     const float* solid_angles, std::size_t count, const std::array<float*, 3>& radiance) {
    const Floats d;
    const RadiancePyramid& pyramid = with_spots ? map.whole : map.smooth;
    const auto zero = hn::Zero(d);
    const auto last = all(d, static_cast<double>(pyramid.levels().size() - 1));
    // At the equator of the pyramid's finest level, where texels are twice as wide as the picture's.
    const double texel = 2 * std::numbers::pi / map.picture->width * std::numbers::pi / map.picture->height;
    const auto offset = all(d, 0.5 * std::log2(texel) + 1);
    for (std::size_t i = 0; i < count; i += kLaneCount<Floats>) {
        const auto wanted = hn::MulSub(all(d, 0.5), hn::Log2(d, hn::LoadU(d, solid_angles + i)), offset);
        const auto level = hn::Min(hn::Max(wanted, all(d, -1)), last);
        const auto finer = hn::Floor(level);
        const Place place = load_place(directions, i);
        const auto coarser = hn::Min(hn::Add(finer, all(d, 1)), last);
        Color fine = on_level(pyramid, hn::Max(finer, zero), place).mean(pyramid.pixels());
        const Color coarse = on_level(pyramid, coarser, place).mean(pyramid.pixels());
        const auto is_finest = hn::Lt(finer, zero);
        if (!hn::AllFalse(d, is_finest)) {
            const Neighbourhood about = on_picture(*map.picture, place);
            const Rgb* pixels = map.picture->pixels.data();
            const Color finest = with_spots ? about.mean(pixels) : about.mean_below(pixels, map.bright.limit);
            for (std::size_t channel = 0; channel < 3; ++channel) {
                fine[channel] = hn::IfThenElse(is_finest, finest[channel], fine[channel]);
            }
        }
        const Color blurred = mixed(fine, coarse, hn::Sub(level, finer));
        for (std::size_t channel = 0; channel < 3; ++channel) {
            hn::StoreU(blurred[channel], d, radiance[channel] + i);
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

void look_up_blurred(const EnvironmentMap& map, bool with_spots, const MapDirections& directions,
                     const float* solid_angles, std::size_t count, const std::array<float*, 3>& radiance) {
    HWY_DYNAMIC_DISPATCH(look_up_blurred)(map, with_spots, directions, solid_angles, count, radiance);
}

}  // namespace shlight
#endif
