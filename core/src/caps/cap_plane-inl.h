// SPDX-License-Identifier: MIT
//
// Batches of caps against the plane z = 0, sorted by what they need. Included once per instruction set.
#if defined(SHLIGHT_KERNELS_CAP_PLANE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_CAP_PLANE_INL_H_
#undef SHLIGHT_KERNELS_CAP_PLANE_INL_H_
#else
#define SHLIGHT_KERNELS_CAP_PLANE_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "caps/cap_batch-inl.h"
#include "caps/cap_spheres-inl.h"
#include "caps/cap_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// Centres and radii.
template <class D>
struct SphereLanes {
    V<D> x, y, z, r;
};

/// Whether spheres cross the plane z = 0, a bit for each; 16 bits higher, whether they are below it.
template <class D>
HWY_INLINE std::uint32_t sides_of(D d, const SphereLanes<D>& s) {
    return bits_of(d, hn::Lt(hn::Abs(s.z), s.r)) | bits_of(d, hn::Le(s.z, hn::Neg(s.r))) << 16;
}

/// Spheres by index.
template <class T>
struct SphereSource {
    static constexpr bool kMayContainHorizon = false;

    const Vec3<T>* centers;
    const T* radii;

    HWY_INLINE SphereLanes<Lanes<T>> spheres(const Chosen<T>& chosen) const {
        const Lanes<T> d;
        constexpr std::size_t kLanes = kLaneCount<Lanes<T>>;
        SphereLanes<Lanes<T>> s;
        if (are_in_a_row(chosen)) {
            hn::LoadInterleaved3(d, &centers[chosen.front()].x, s.x, s.y, s.z);
            s.r = hn::LoadU(d, radii + chosen.front());
            return s;
        }
        alignas(64) std::array<T, 3 * kLanes> c;
        alignas(64) std::array<T, kLanes> own_radii;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const Vec3<T>& center = centers[chosen[lane]];
            c[3 * lane] = center.x;
            c[3 * lane + 1] = center.y;
            c[3 * lane + 2] = center.z;
            own_radii[lane] = radii[chosen[lane]];
        }
        hn::LoadInterleaved3(d, c.data(), s.x, s.y, s.z);
        s.r = hn::Load(d, own_radii.data());
        return s;
    }

    HWY_INLINE CircleLanes<Lanes<T>> load(const Chosen<T>& chosen) const {
        const auto s = spheres(chosen);
        return circle_of_sphere_in_lanes(Lanes<T>(), s.x, s.y, s.z, s.r);
    }

    /// Of neighbours, as sides_of.
    HWY_INLINE std::uint32_t sides(std::size_t first, std::size_t count) const {
        Chosen<T> chosen;
        for (std::size_t lane = 0; lane < chosen.size(); ++lane) {
            chosen[lane] = static_cast<std::uint32_t>(first + std::min(lane, count - 1));
        }
        const std::uint32_t all_lanes = (1U << count) - 1;
        return sides_of(Lanes<T>(), spheres(chosen)) & (all_lanes | all_lanes << 16);
    }
};

/// A whole batch against the plane z = 0, sorted by need.
template <class T, class Source, class Sink>
class PlaneBatch {
  public:
    PlaneBatch(const Source& source, const Sink& sink, bool clip)
        : source_(source), sink_(sink), clip_(clip), choice_(sink.order()) {}

    HWY_INLINE void run(std::size_t first, std::size_t last) {
        crossing_.clear();
        uncrossed_.clear();
        constexpr std::size_t kLanes = kLaneCount<D>;
        for (std::size_t i = first; i < last; i += kLanes) {
            const std::size_t count = std::min(kLanes, last - i);
            const std::uint32_t all_lanes = (1U << count) - 1;
            const std::uint32_t sides = clip_ ? source_.sides(i, count) : 0;
            const std::uint32_t hidden = sides >> 16;
            crossing_.add_block(i, count, sides & all_lanes);
            uncrossed_.add_block(i, count, all_lanes & ~(sides | hidden));
            for (std::size_t j = 0; hidden >> j != 0; ++j) {
                if ((hidden >> j & 1U) != 0) {
                    sink_.hide(i + j);
                }
            }
        }
        run_group<true>(crossing_);
        run_group<false>(uncrossed_);
    }

  private:
    using D = Lanes<T>;

    template <bool kCrossing>
    HWY_INLINE void run_group(const LightList& lights) {
        using Bands = BandsOf<T, kCrossing, true, Source::kMayContainHorizon>;
        most_.clear();
        others_.clear();
        lights.for_each_vector<T>([&](const Chosen<T>& chosen) HWY_ATTR {
            const auto cap = load<kCrossing>(chosen);
            const auto others = choice_.template others<kCrossing>(cap);
            if (hn::AllFalse(D(), others)) {
                sink_.template take<typename Bands::Most>(cap, chosen);
            } else {
                most_.add_marked(D(), hn::Not(others), chosen);
                others_.add_marked(D(), others, chosen);
            }
        });
        take_all<kCrossing, typename Bands::Most>(most_);
        take_all<kCrossing, typename Bands::Others>(others_);
    }

    template <bool kCrossing, class Recurrences>
    HWY_INLINE void take_all(const LightList& lights) {
        lights.for_each_vector<T>([&](const Chosen<T>& chosen)
                                      HWY_ATTR { sink_.template take<Recurrences>(load<kCrossing>(chosen), chosen); });
    }

    template <bool kCrossing>
    HWY_INLINE CapLanes<D> load(const Chosen<T>& chosen) const {
        const D d;
        const auto circle = source_.load(chosen);
        if constexpr (kCrossing) {
            return cap_across_plane(d, circle);
        } else {
            return clip_ ? cap_off_plane(d, circle) : unclipped_cap(d, circle);
        }
    }

    Source source_;
    const Sink& sink_;
    bool clip_;
    BandChoice<T> choice_;
    LightList crossing_, uncrossed_;
    LightList most_, others_;  // of vectors that have both
};

template <class T, class Source, class Sink>
void run_batch(const Source& source, std::size_t count, bool clip, const Sink& sink) {
    PlaneBatch<T, Source, Sink> batch(source, sink, clip);
    for (std::size_t first = 0; first < count; first += LightList::kMost) {
        batch.run(first, std::min(count, first + LightList::kMost));
    }
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
