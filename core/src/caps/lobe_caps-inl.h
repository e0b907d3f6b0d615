// SPDX-License-Identifier: MIT
//
// Caps multiplied with the terms of lobes, in batches sorted by what lights need. Included once per instruction set.
#if defined(SHLIGHT_KERNELS_LOBE_CAPS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_LOBE_CAPS_INL_H_
#undef SHLIGHT_KERNELS_LOBE_CAPS_INL_H_
#else
#define SHLIGHT_KERNELS_LOBE_CAPS_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "caps/cap_batch-inl.h"
#include "caps/cap_sums-inl.h"
#include "simd/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// The lights in a vector's lanes.
using Lights = Chosen<float>;

/// One vector for each cosine term; a square of columns may be written at once.
using TermLanes = std::array<float, (kCosineMax + kSquare<Floats>)*kLaneCount<Floats>>;

/// Terms that all lights share.
HWY_INLINE void repeat_terms(const float* from, std::size_t count, TermLanes& terms) {
    const Floats d;
    for (std::size_t k = 0; k < count; ++k) {
        hn::Store(hn::Set(d, from[k]), d, terms.data() + k * kLaneCount<Floats>);
    }
}

/// Σ f_lm L_lm.
template <class Bands>
HWY_NOINLINE void shade_lanes(const CapLanes<Floats>& cap, std::size_t order, const TermLanes& terms, float* sums) {
    ShadingVisitor<float> visit(cap, order, terms.data());
    solve_bands(Bands(cap, order), order, visit);
    hn::StoreU(visit.sum(), Floats(), sums);
}

/// Source: where lights and lobes come from.
///   order(), kPlane: whether the lobes have no warp;
///   share(terms): writes the terms that all lights share, if they do;
///   load(chosen): what is known of lights in lanes before their caps;
///   sides(loaded): which of them cross the plane z = 0, a bit for each, and 16 bits higher which are below it;
///   prepare<kCrossing>(loaded, chosen, cap, terms): their caps, and their terms unless they share them.
template <class Source>
class ShadingBatch {
  public:
    ShadingBatch(const Source& source, float* values)
        : source_(source), values_(values), order_(static_cast<std::size_t>(source.order())), choice_(order_) {
        source_.share(terms_);
    }

    void run(std::size_t count) {
        for (std::size_t first = 0; first < count; first += LightList::kMost) {
            run_part(first, std::min(count, first + LightList::kMost));
        }
    }

  private:
    static constexpr std::size_t kLanes = kLaneCount<Floats>;
    using Loaded = typename Source::Loaded;

    void run_part(std::size_t first, std::size_t last) {
        crossing_.clear();
        uncrossed_.clear();
        others_[0].clear();
        others_[1].clear();
        std::fill(values_ + first, values_ + last, 0.0F);
        for (std::size_t i = first; i < last; i += kLanes) {
            sort(i, std::min(kLanes, last - i));
        }
        run_group<true>(crossing_);
        run_group<false>(uncrossed_);
    }

    /// Lights that lie side by side and need the same are shaded at once, others are put on lists.
    HWY_INLINE void sort(std::size_t first, std::size_t count) {
        Lights chosen;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            chosen[lane] = static_cast<std::uint32_t>(first + std::min(lane, count - 1));
        }
        const Loaded loaded = source_.load(chosen);
        const std::uint32_t sides = source_.sides(loaded);
        const std::uint32_t all_lanes = (1U << count) - 1;
        const std::uint32_t crossing = sides & all_lanes;
        if (crossing == (1U << kLanes) - 1) {
            shade_most<true>(loaded, chosen);
            return;
        }
        crossing_.add_block(first, count, crossing);
        uncrossed_.add_block(first, count, ~(sides | sides >> 16) & all_lanes);
    }

    template <bool kCrossing>
    using Bands = BandsOf<float, kCrossing, Source::kPlane, true>;

    template <bool kCrossing>
    HWY_INLINE void run_group(const LightList& lights) {
        lights.for_each_vector<float>([&](const Lights& chosen)
                                          HWY_ATTR { shade_most<kCrossing>(source_.load(chosen), chosen); });
        others_[kCrossing].for_each_vector<float>([&](const Lights& chosen) HWY_ATTR {
            CapLanes<Floats> cap;
            prepare<kCrossing>(source_.load(chosen), chosen, cap);
            shade<typename Bands<kCrossing>::Others>(cap, chosen);
        });
    }

    /// Lanes that need other recurrences are put on a list, to be shaded again.
    template <bool kCrossing>
    HWY_INLINE void shade_most(const Loaded& loaded, const Lights& chosen) {
        const Floats d;
        CapLanes<Floats> cap;
        prepare<kCrossing>(loaded, chosen, cap);
        const auto others = choice_.others<kCrossing>(cap);
        if (!hn::AllTrue(d, others)) {
            shade<typename Bands<kCrossing>::Most>(cap, chosen);
        }
        if (!hn::AllFalse(d, others)) {
            others_[kCrossing].add_marked(d, others, chosen);
        }
    }

    template <bool kCrossing>
    HWY_NOINLINE void prepare(const Loaded& loaded, const Lights& chosen, CapLanes<Floats>& cap) {
        source_.template prepare<kCrossing>(loaded, chosen, cap, terms_);
    }

    template <class Recurrences>
    HWY_INLINE void shade(const CapLanes<Floats>& cap, const Lights& chosen) {
        if (are_in_a_row(chosen)) {
            shade_lanes<Recurrences>(cap, order_, terms_, values_ + chosen[0]);
            return;
        }
        alignas(64) std::array<float, kLanes> sums;
        shade_lanes<Recurrences>(cap, order_, terms_, sums.data());
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            values_[chosen[lane]] = sums[lane];
        }
    }

    Source source_;
    float* values_;
    std::size_t order_;
    BandChoice<float> choice_;
    LightList crossing_, uncrossed_;
    std::array<LightList, 2> others_;  // of circles that do not cross the horizon, and that do
    alignas(64) TermLanes terms_;
};

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
