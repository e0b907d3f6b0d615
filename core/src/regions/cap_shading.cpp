// SPDX-License-Identifier: MIT
#include "regions/cap_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "regions/cap_shading.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "regions/cap_groups-inl.h"
#include "simd/gather-inl.h"
#include "simd/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

constexpr std::size_t kLanes = kLaneCount<Floats>;
constexpr std::size_t kBlock = kSquare<Floats>;

using Lights = Chosen<float>;

/// One vector for each cosine term; a square of columns may be written at once.
using TermLanes = std::array<float, (kCosineMax + kBlock) * kLanes>;

HWY_INLINE Lights listed(const std::uint32_t* list, const Lights& chosen) {
    Lights result;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
        result[lane] = list[chosen[lane]];
    }
    return result;
}

/// Numbers: Contiguous, Gather or Broadcast.
template <class Numbers>
HWY_INLINE BoostPair boosts_of(const BoostArrays& boosts, const Numbers& numbers) {
    return {load_boosts(boosts, [&](const double* values) HWY_ATTR { return numbers.pair(values).low; }),
            load_boosts(boosts, [&](const double* values) HWY_ATTR { return numbers.pair(values).high; })};
}

/// Σ f_lm L_lm.
template <class Bands>
HWY_NOINLINE void shade_lanes(const ClippedCap<Floats>& cap, std::size_t order, const TermLanes& terms, float* sums) {
    ShadingVisitor<float> visit(cap, order, terms.data());
    solve_bands(Bands(cap, order), order, visit);
    hn::StoreU(visit.sum(), Floats(), sums);
}

/// Caps multiplied with the terms of lobes. kWithoutBoost: all of them.
template <class Source, bool kWithoutBoost>
class CapShading {
  public:
    using Caps = Source;
    static constexpr bool kPlane = kWithoutBoost;

    CapShading(const Caps& caps, const LobeArrays& lobe, const std::uint32_t* view_of, float* values)
        : caps_(caps), lobe_(lobe), view_of_(view_of), values_(values) {
        for (std::size_t k = 0; lobe.stride == 0 && k < term_count(); ++k) {
            hn::Store(hn::Set(Floats(), lobe.terms[k]), Floats(), terms_.data() + k * kLanes);
        }
    }

    std::size_t order() const { return static_cast<std::size_t>(lobe_.order); }
    static constexpr bool kept_whole() { return false; }
    const Caps& caps() const { return caps_; }
    static void hide(std::size_t /*first*/, std::uint32_t /*bits*/) {}  // all values were zero

    template <bool kCrossing>
    HWY_NOINLINE void prepare(const typename Caps::Loaded& loaded, const Lights& chosen, ClippedCap<Floats>& cap) {
        if constexpr (kPlane) {
            cap = cap_at_plane<kCrossing>(Floats(), Caps::narrow(loaded));
        } else {
            const CapPair caps = Caps::pair(loaded);
            const BoostPair boosts = load_boosts(chosen);
            const auto low = boosted_contact(caps.low, boosts.low);
            const auto high = boosted_contact(caps.high, boosts.high);
            cap = cap_in_contact(Floats(), narrowed_contact<float>(low, high));
        }
        if (lobe_.stride != 0) {
            load_terms(listed(view_of_, chosen));
        }
    }

    template <class Bands>
    HWY_INLINE void take(const ClippedCap<Floats>& cap, const Lights& chosen) const {
        if (are_in_a_row(Floats(), chosen.data())) {
            shade_lanes<Bands>(cap, order(), terms_, values_ + chosen[0]);
            return;
        }
        alignas(64) std::array<float, kLanes> sums;
        shade_lanes<Bands>(cap, order(), terms_, sums.data());
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            values_[chosen[lane]] = sums[lane];
        }
    }

  private:
    std::size_t term_count() const { return order() * (order() + 1) / 2; }

    HWY_INLINE BoostPair load_boosts(const Lights& chosen) const {
        if (lobe_.stride == 0) {
            return boosts_of(lobe_.boosts, Broadcast(view_of_, kLanes));
        }
        const Lights view_of = listed(view_of_, chosen);
        return are_in_a_row(Floats(), view_of.data()) ? boosts_of(lobe_.boosts, Contiguous(view_of[0]))
                                                      : boosts_of(lobe_.boosts, Gather(view_of.data(), kLanes));
    }

    /// Each lane's own terms.
    HWY_INLINE void load_terms(const Lights& view_of) {
        const Floats d;
        std::array<const float*, kLanes> rows;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            rows[lane] = lobe_.terms + view_of[lane] * lobe_.stride;
        }
        for (std::size_t k = 0; k < term_count(); k += kBlock) {
            const auto columns = load_columns(d, rows.data(), k);
            for (std::size_t j = 0; j < kBlock; ++j) {
                hn::Store(columns[j], d, terms_.data() + (k + j) * kLanes);
            }
        }
    }

    Caps caps_;
    LobeArrays lobe_;
    const std::uint32_t* view_of_;
    float* values_;
    alignas(64) TermLanes terms_;
};

template <class Caps>
void shade_in_lanes(const Caps& caps, const LobeArrays& lobe, const std::uint32_t* view_of, std::size_t count,
                    float* values) {
    std::fill_n(values, count, 0.0F);
    const auto run = [&](auto&& work) { CapGroups(work).run(count); };
    if (lobe.boosted) {
        run(CapShading<Caps, false>(caps, lobe, view_of, values));
    } else {
        run(CapShading<Caps, true>(caps, lobe, view_of, values));
    }
}

void shade_caps_in_lanes(const CapArrays& caps, const std::uint32_t* cap_of, const LobeArrays& lobe,
                         const std::uint32_t* view_of, std::size_t count, float* values) {
    shade_in_lanes(StoredCaps<float>(caps, cap_of), lobe, view_of, count, values);
}

void shade_spheres_in_lanes(const SphereArrays& spheres, const LobeArrays& lobe, const std::uint32_t* view_of,
                            std::size_t count, float* values) {
    shade_in_lanes(SphereCaps(spheres), lobe, view_of, count, values);
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(shade_caps_in_lanes);
HWY_EXPORT(shade_spheres_in_lanes);

void shade_caps(const CapArrays& caps, std::span<const std::uint32_t> cap_of, const LobeArrays& lobe,
                std::span<const std::uint32_t> view_of, std::span<float> values) {
    HWY_DYNAMIC_DISPATCH(shade_caps_in_lanes)
    (caps, cap_of.data(), lobe, view_of.data(), values.size(), values.data());
}

void shade_caps(const SphereArrays& spheres, const LobeArrays& lobe, std::span<const std::uint32_t> view_of,
                std::span<float> values) {
    HWY_DYNAMIC_DISPATCH(shade_spheres_in_lanes)(spheres, lobe, view_of.data(), values.size(), values.data());
}

}  // namespace shlight
#endif
