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
#include "caps/lobe_caps-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

constexpr std::size_t kLanes = kLaneCount<Floats>;
constexpr std::size_t kHalf = kLaneCount<Doubles>;
constexpr std::size_t kBlock = kSquare<Floats>;

/// Eight or so numbers of an array: those of a vector's lights.
HWY_INLINE V<Doubles> gathered(const double* values, const std::uint32_t* indices, bool in_a_row) {
    const Doubles d;
    if (in_a_row) {
        return hn::LoadU(d, values + indices[0]);
    }
    alignas(64) std::array<double, kHalf> lanes;
    for (std::size_t i = 0; i < kHalf; ++i) {
        lanes[i] = values[indices[i]];
    }
    return hn::Load(d, lanes.data());
}

HWY_INLINE bool all_in_a_row(const std::uint32_t* indices) {
    bool result = true;
    for (std::size_t i = 1; i < kHalf; ++i) {
        result = result & (indices[i] == indices[0] + i);
    }
    return result;
}

HWY_INLINE CircleLanes<Doubles> load_circle(const CircleArrays& circles, const std::uint32_t* indices) {
    const Doubles d;
    const bool in_a_row = all_in_a_row(indices);
    CircleLanes<Doubles> circle{gathered(circles.x, indices, in_a_row),
                                gathered(circles.y, indices, in_a_row),
                                gathered(circles.z, indices, in_a_row),
                                gathered(circles.cosine, indices, in_a_row),
                                gathered(circles.sine, indices, in_a_row),
                                hn::Zero(d),
                                hn::Zero(d)};
    set_squares(d, circle);
    return circle;
}

HWY_INLINE WarpLanes<Doubles> load_warp(const WarpArrays& warps, const std::uint32_t* indices) {
    const bool in_a_row = all_in_a_row(indices);
    const auto get = [&](const double* values) HWY_ATTR { return gathered(values, indices, in_a_row); };
    return {get(warps.sin_tilt),        get(warps.cos_tilt),       get(warps.speed),
            get(warps.one_minus_speed), get(warps.gamma),          get(warps.horizon_x),
            get(warps.horizon_z),       get(warps.horizon_height), get(warps.horizon_sine)};
}

/// Circles and lobes by index.
template <bool kWithoutWarp>
class IndexedCaps {
  public:
    static constexpr bool kPlane = kWithoutWarp;
    struct Loaded {
        CircleLanes<Doubles> low, high;
    };

    IndexedCaps(const CircleArrays& circles, const std::uint32_t* circle_of, const LobeArrays& lobe,
                const std::uint32_t* view_of)
        : circles_(circles), circle_of_(circle_of), lobe_(lobe), view_of_(view_of) {}

    int order() const { return lobe_.order; }

    HWY_INLINE void share(TermLanes& terms) const {
        if (lobe_.stride == 0) {
            repeat_terms(lobe_.terms, term_count(), terms);
        }
    }

    HWY_INLINE Loaded load(const Lights& chosen) const {
        const Lights circle_of = listed(circle_of_, chosen);
        return {load_circle(circles_, circle_of.data()), load_circle(circles_, circle_of.data() + kLanes - kHalf)};
    }

    static HWY_INLINE std::uint32_t sides(const Loaded& circles) {
        const Doubles d;
        const auto half = [&](const CircleLanes<Doubles>& circle) HWY_ATTR {
            const auto zero = hn::Zero(d);
            const auto crossing = hn::Gt(circle.crossing_squared, zero);
            const auto hidden = hn::AndNot(crossing, hn::And(hn::Lt(circle.z, zero), hn::Ge(circle.cosine, zero)));
            return bits_of(d, crossing) | bits_of(d, hidden) << 16;
        };
        return half(circles.low) | half(circles.high) << (kLanes - kHalf);
    }

    template <bool kCrossing>
    HWY_INLINE void prepare(const Loaded& circles, const Lights& chosen, CapLanes<Floats>& cap,
                            TermLanes& terms) const {
        const Lights view_of = listed(view_of_, chosen);
        if constexpr (kPlane) {
            const auto circle = narrowed_circle<float>(circles.low, circles.high);
            cap = kCrossing ? cap_across_plane(Floats(), circle) : cap_off_plane(Floats(), circle);
        } else {
            const auto low = warped_contact(Doubles(), circles.low, load_warp(lobe_.warps, view_of.data()));
            const auto high =
                warped_contact(Doubles(), circles.high, load_warp(lobe_.warps, view_of.data() + kLanes - kHalf));
            cap = cap_in_contact(Floats(), narrowed_contact<float>(low, high));
        }
        if (lobe_.stride != 0) {
            load_terms(view_of, terms);
        }
    }

  private:
    std::size_t term_count() const { return static_cast<std::size_t>(lobe_.order * (lobe_.order + 1) / 2); }

    static HWY_INLINE Lights listed(const std::uint32_t* list, const Lights& chosen) {
        Lights result;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            result[lane] = list[chosen[lane]];
        }
        return result;
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

    CircleArrays circles_;
    const std::uint32_t* circle_of_;
    LobeArrays lobe_;
    const std::uint32_t* view_of_;
};

void shade_caps_in_lanes(const CircleArrays& circles, const std::uint32_t* circle_of, const LobeArrays& lobe,
                         const std::uint32_t* view_of, std::size_t count, float* values) {
    if (lobe.warped) {
        ShadingBatch<IndexedCaps<false>>({circles, circle_of, lobe, view_of}, values).run(count);
    } else {
        ShadingBatch<IndexedCaps<true>>({circles, circle_of, lobe, view_of}, values).run(count);
    }
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(shade_caps_in_lanes);

void shade_caps(const CircleArrays& circles, std::span<const std::uint32_t> circle_of, const LobeArrays& lobe,
                std::span<const std::uint32_t> view_of, std::span<float> values) {
    HWY_DYNAMIC_DISPATCH(shade_caps_in_lanes)
    (circles, circle_of.data(), lobe, view_of.data(), values.size(), values.data());
}

}  // namespace shlight
#endif
