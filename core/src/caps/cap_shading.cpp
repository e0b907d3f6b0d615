// SPDX-License-Identifier: MIT
#include "caps/cap_shading.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "caps/cap_shading.cpp"
#include <hwy/foreach_target.h>
// Highway's vocabulary, and what is compiled once per instruction set, come after it.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "caps/cap_batch-inl.h"
#include "caps/cap_plane-inl.h"
#include "caps/cap_spheres-inl.h"
#include "caps/lobe_caps-inl.h"
#include "simd/gather-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

constexpr std::size_t kLanes = kLaneCount<Floats>;
constexpr std::size_t kBlock = kSquare<Floats>;

HWY_INLINE bool follow_each_other(const Lights& indices) {
    const hn::RebindToUnsigned<Floats> d;
    return hn::AllTrue(d, hn::Eq(hn::LoadU(d, indices.data()), hn::Iota(d, indices[0])));
}

HWY_INLINE Lights listed(const std::uint32_t* list, const Lights& chosen) {
    Lights result;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        result[lane] = list[chosen[lane]];
    }
    return result;
}

struct CirclePair {
    CircleLanes<Doubles> low, high;
};

/// Numbers: Neighbours or Scattered.
template <class Numbers>
HWY_INLINE CirclePair circles_of(const CircleArrays& circles, const Numbers& numbers) {
    const Doubles d;
    const DoublePair x = numbers.pair(circles.x);
    const DoublePair y = numbers.pair(circles.y);
    const DoublePair z = numbers.pair(circles.z);
    const DoublePair cosine = numbers.pair(circles.cosine);
    const DoublePair sine = numbers.pair(circles.sine);
    CirclePair pair{{x.low, y.low, z.low, cosine.low, sine.low, hn::Zero(d), hn::Zero(d)},
                    {x.high, y.high, z.high, cosine.high, sine.high, hn::Zero(d), hn::Zero(d)}};
    set_squares(d, pair.low);
    set_squares(d, pair.high);
    return pair;
}

/// Numbers: Neighbours, Scattered or Same.
template <class Numbers>
HWY_INLINE WarpPair warps_of(const WarpArrays& warps, const Numbers& numbers) {
    const DoublePair sin_tilt = numbers.pair(warps.sin_tilt);
    const DoublePair cos_tilt = numbers.pair(warps.cos_tilt);
    const DoublePair speed = numbers.pair(warps.speed);
    const DoublePair one_minus_speed = numbers.pair(warps.one_minus_speed);
    const DoublePair gamma = numbers.pair(warps.gamma);
    const DoublePair horizon_x = numbers.pair(warps.horizon_x);
    const DoublePair horizon_z = numbers.pair(warps.horizon_z);
    const DoublePair height = numbers.pair(warps.horizon_height);
    const DoublePair sine = numbers.pair(warps.horizon_sine);
    return {{sin_tilt.low, cos_tilt.low, speed.low, one_minus_speed.low, gamma.low, horizon_x.low, horizon_z.low,
             height.low, sine.low},
            {sin_tilt.high, cos_tilt.high, speed.high, one_minus_speed.high, gamma.high, horizon_x.high, horizon_z.high,
             height.high, sine.high}};
}

/// Circles from memory, by number.
class StoredCircles {
  public:
    using Loaded = CirclePair;

    StoredCircles(const CircleArrays& circles, const std::uint32_t* numbers) : circles_(circles), numbers_(numbers) {}

    HWY_INLINE Loaded load(const Lights& chosen) const {
        const Lights numbers = listed(numbers_, chosen);
        return follow_each_other(numbers) ? circles_of(circles_, Neighbours(numbers[0]))
                                          : circles_of(circles_, Scattered(numbers.data(), kLanes));
    }

    static HWY_INLINE std::uint32_t sides(const Loaded& circles) {
        const Doubles d;
        const auto half = [&](const CircleLanes<Doubles>& circle) HWY_ATTR {
            const auto zero = hn::Zero(d);
            const auto crossing = hn::Gt(circle.crossing_squared, zero);
            const auto hidden = hn::AndNot(crossing, hn::And(hn::Lt(circle.z, zero), hn::Ge(circle.cosine, zero)));
            return bits_of(d, crossing) | bits_of(d, hidden) << 16;
        };
        return half(circles.low) | half(circles.high) << kLaneCount<Doubles>;
    }

    static HWY_INLINE CirclePair pair(const Loaded& circles) { return circles; }
    static HWY_INLINE CircleLanes<Floats> narrow(const Loaded& circles) {
        return narrowed_circle<float>(circles.low, circles.high);
    }

  private:
    CircleArrays circles_;
    const std::uint32_t* numbers_;
};

/// Circles of spheres, computed where they are loaded.
class SphereCircles {
  public:
    using Loaded = SphereLanes<Floats>;

    explicit SphereCircles(const SphereArrays& spheres) : source_{spheres.centers, spheres.radii} {}

    HWY_INLINE Loaded load(const Lights& chosen) const { return source_.spheres(chosen); }
    static HWY_INLINE std::uint32_t sides(const Loaded& spheres) { return sides_of(Floats(), spheres); }

    static HWY_INLINE CirclePair pair(const Loaded& s) {
        const Doubles d;
        const hn::Half<Floats> half;
        const auto halves = [&](V<Floats> v) HWY_ATTR {
            return DoublePair{hn::PromoteTo(d, hn::LowerHalf(half, v)), hn::PromoteTo(d, hn::UpperHalf(half, v))};
        };
        const DoublePair x = halves(s.x);
        const DoublePair y = halves(s.y);
        const DoublePair z = halves(s.z);
        const DoublePair r = halves(s.r);
        return {circle_of_floats(x.low, y.low, z.low, r.low), circle_of_floats(x.high, y.high, z.high, r.high)};
    }
    static HWY_INLINE CircleLanes<Floats> narrow(const Loaded& s) {
        return circle_of_sphere_in_lanes(Floats(), s.x, s.y, s.z, s.r);
    }

  private:
    SphereSource<float> source_;
};

/// Caps inside circles under the lobes of views.
template <class Circles, bool kWithoutWarp>
class SeenCaps {
  public:
    static constexpr bool kPlane = kWithoutWarp;
    using Loaded = typename Circles::Loaded;

    SeenCaps(const Circles& circles, const LobeArrays& lobe, const std::uint32_t* view_of)
        : circles_(circles), lobe_(lobe), view_of_(view_of) {}

    int order() const { return lobe_.order; }

    HWY_INLINE void share(TermLanes& terms) const {
        if (lobe_.stride == 0) {
            repeat_terms(lobe_.terms, term_count(), terms);
        }
    }

    HWY_INLINE Loaded load(const Lights& chosen) const { return circles_.load(chosen); }
    static HWY_INLINE std::uint32_t sides(const Loaded& loaded) { return Circles::sides(loaded); }

    template <bool kCrossing>
    HWY_INLINE void prepare(const Loaded& loaded, const Lights& chosen, CapLanes<Floats>& cap, TermLanes& terms) const {
        if constexpr (kPlane) {
            const auto circle = Circles::narrow(loaded);
            cap = kCrossing ? cap_across_plane(Floats(), circle) : cap_off_plane(Floats(), circle);
        } else {
            const CirclePair circles = Circles::pair(loaded);
            const WarpPair warps = load_warps(chosen);
            const auto low = warped_contact(Doubles(), circles.low, warps.low);
            const auto high = warped_contact(Doubles(), circles.high, warps.high);
            cap = cap_in_contact(Floats(), narrowed_contact<float>(low, high));
        }
        if (lobe_.stride != 0) {
            load_terms(listed(view_of_, chosen), terms);
        }
    }

  private:
    std::size_t term_count() const { return static_cast<std::size_t>(lobe_.order * (lobe_.order + 1) / 2); }

    HWY_INLINE WarpPair load_warps(const Lights& chosen) const {
        if (lobe_.stride == 0) {
            return warps_of(lobe_.warps, Same(view_of_, kLanes));
        }
        const Lights view_of = listed(view_of_, chosen);
        return follow_each_other(view_of) ? warps_of(lobe_.warps, Neighbours(view_of[0]))
                                          : warps_of(lobe_.warps, Scattered(view_of.data(), kLanes));
    }

    /// Each lane's own terms.
    HWY_INLINE void load_terms(const Lights& view_of, TermLanes& terms) const {
        const Floats d;
        std::array<const float*, kLanes> rows;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            rows[lane] = lobe_.terms + view_of[lane] * lobe_.stride;
        }
        for (std::size_t k = 0; k < term_count(); k += kBlock) {
            const auto columns = load_columns(d, rows.data(), k);
            for (std::size_t j = 0; j < kBlock; ++j) {
                hn::Store(columns[j], d, terms.data() + (k + j) * kLanes);
            }
        }
    }

    Circles circles_;
    LobeArrays lobe_;
    const std::uint32_t* view_of_;
};

template <class Circles>
void shade_in_lanes(const Circles& circles, const LobeArrays& lobe, const std::uint32_t* view_of, std::size_t count,
                    float* values) {
    if (lobe.warped) {
        ShadingBatch<SeenCaps<Circles, false>>({circles, lobe, view_of}, values).run(count);
    } else {
        ShadingBatch<SeenCaps<Circles, true>>({circles, lobe, view_of}, values).run(count);
    }
}

void shade_circles_in_lanes(const CircleArrays& circles, const std::uint32_t* circle_of, const LobeArrays& lobe,
                            const std::uint32_t* view_of, std::size_t count, float* values) {
    shade_in_lanes(StoredCircles(circles, circle_of), lobe, view_of, count, values);
}

void shade_spheres_in_lanes(const SphereArrays& spheres, const LobeArrays& lobe, const std::uint32_t* view_of,
                            std::size_t count, float* values) {
    shade_in_lanes(SphereCircles(spheres), lobe, view_of, count, values);
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(shade_circles_in_lanes);
HWY_EXPORT(shade_spheres_in_lanes);

void shade_caps(const CircleArrays& circles, std::span<const std::uint32_t> circle_of, const LobeArrays& lobe,
                std::span<const std::uint32_t> view_of, std::span<float> values) {
    HWY_DYNAMIC_DISPATCH(shade_circles_in_lanes)
    (circles, circle_of.data(), lobe, view_of.data(), values.size(), values.data());
}

void shade_caps(const SphereArrays& spheres, const LobeArrays& lobe, std::span<const std::uint32_t> view_of,
                std::span<float> values) {
    HWY_DYNAMIC_DISPATCH(shade_spheres_in_lanes)(spheres, lobe, view_of.data(), values.size(), values.data());
}

}  // namespace shlight
#endif
