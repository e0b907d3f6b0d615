// SPDX-License-Identifier: MIT
//
// Lights of a batch sorted by what they need, so that a vector is of one kind and no result depends on a lane's
// neighbours. Included once per instruction set.
#if defined(SHLIGHT_KERNELS_CAP_BATCH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_CAP_BATCH_INL_H_
#undef SHLIGHT_KERNELS_CAP_BATCH_INL_H_
#else
#define SHLIGHT_KERNELS_CAP_BATCH_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "regions/cap_arrays.h"
#include "regions/cap_lanes-inl.h"
#include "regions/cap_sums-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// The lights in the lanes of a vector.
template <class T>
using Chosen = std::array<std::uint32_t, kLaneCount<Lanes<T>>>;

/// Compilers fold Iota of a constant only.
template <class D>
HWY_INLINE V<hn::Rebind<std::uint32_t, D>> row_from(D /*d*/, std::size_t first) {
    const hn::Rebind<std::uint32_t, D> du;
    return hn::Add(hn::Iota(du, 0), hn::Set(du, static_cast<std::uint32_t>(first)));
}

/// All of them: a list of lights whose recurrences are taken again need not ascend.
template <class D>
HWY_INLINE bool are_in_a_row(D d, const std::uint32_t* indices) {
    const hn::Rebind<std::uint32_t, D> du;
    return hn::AllTrue(du, hn::Eq(hn::LoadU(du, indices), row_from(d, indices[0])));
}

/// A bit for each lane, the first lane's lowest.
template <class D>
HWY_INLINE std::uint32_t bits_of(D d, M<D> mask) {
    std::uint64_t bits = 0;
    std::array<std::uint8_t, sizeof bits> bytes{};
    hn::StoreMaskBits(d, mask, bytes.data());
    std::memcpy(&bits, bytes.data(), sizeof bits);
    return static_cast<std::uint32_t>(bits);
}

/// Lights of a chunk that have the same needs.
class LightList {
  public:
    static constexpr std::size_t kMost = 2048;

    /// Adds those of the lights first … first + count - 1, at most 16, whose bits are set.
    HWY_INLINE void add_block(std::size_t first, std::size_t count, std::uint32_t bits) {
        if (bits == (1U << count) - 1) {
            for (std::size_t j = 0; j < count; ++j) {
                indices_[count_ + j] = static_cast<std::uint32_t>(first + j);
            }
            count_ += count;
        } else if (bits != 0) {
            for (std::size_t j = 0; j < count; ++j) {
                add_if((bits >> j & 1U) != 0, static_cast<std::uint32_t>(first + j));
            }
        }
    }
    /// Adds the marked lanes; the last lights of a vector may be the same one.
    template <class D>
    HWY_INLINE void add_marked(D d, M<D> marked, const Chosen<Scalar<D>>& chosen) {
        const std::uint32_t bits = bits_of(d, marked);
        for (std::size_t lane = 0; lane < chosen.size(); ++lane) {
            add_if((bits >> lane & 1U) != 0 && (lane == 0 || chosen[lane] != chosen[lane - 1]), chosen[lane]);
        }
    }
    void clear() { count_ = 0; }

    /// visit(chosen) for each vector full of lights; the last is filled up with the last light.
    template <class T, class Visit>
    HWY_INLINE void for_each_vector(const Visit& visit) const {
        Chosen<T> chosen;
        for (std::size_t first = 0; first < count_; first += chosen.size()) {
            const std::size_t lanes = std::min(chosen.size(), count_ - first);
            const auto* begin = indices_.begin() + first;
            std::fill(std::copy_n(begin, lanes, chosen.begin()), chosen.end(), begin[lanes - 1]);
            visit(chosen);
        }
    }

  private:
    /// Without a branch.
    HWY_INLINE void add_if(bool wanted, std::uint32_t light) {
        indices_[count_] = light;
        count_ += wanted ? 1 : 0;
    }

    std::array<std::uint32_t, kMost + 1> indices_;
    std::size_t count_ = 0;
};

/// The caps in a vector's lanes: the lower half and the upper, which are the same if it is one of doubles.
struct CapPair {
    SphericalCapLanes<Doubles> low, high;
};

/// A vector of what is at so many indices.
template <class D>
HWY_INLINE V<D> gathered(D d, const double* values, const std::uint32_t* indices) {
    if constexpr (hn::MaxLanes(d) > 2) {
        const hn::Half<D> half;
        return hn::Combine(d, gathered(half, values, indices + hn::MaxLanes(half)), gathered(half, values, indices));
    } else {
        return hn::OddEven(hn::Set(d, values[indices[1]]), hn::Set(d, values[indices[0]]));
    }
}

HWY_INLINE V<Doubles> loaded(const double* values, const std::uint32_t* indices, bool in_a_row) {
    return in_a_row ? hn::LoadU(Doubles(), values + indices[0]) : gathered(Doubles(), values, indices);
}

HWY_INLINE SphericalCapLanes<Doubles> load_cap(const CapArrays& caps, const std::uint32_t* indices) {
    const bool in_a_row = are_in_a_row(Doubles(), indices);
    const auto x = loaded(caps.x, indices, in_a_row);
    const auto y = loaded(caps.y, indices, in_a_row);
    return {x,
            y,
            loaded(caps.z, indices, in_a_row),
            loaded(caps.cosine, indices, in_a_row),
            loaded(caps.sine, indices, in_a_row),
            hn::MulAdd(x, x, hn::Mul(y, y)),
            loaded(caps.crossing_squared, indices, in_a_row)};
}

/// A bit for each lane: which caps cross the plane z = 0, or lie below it.
struct Sides {
    std::uint32_t crossing, hidden;
};

/// Caps from memory, by number, or those of the lights' own numbers.
template <class T>
class StoredCaps {
  public:
    using Number = T;
    using Loaded = CapPair;

    explicit StoredCaps(const CapArrays& caps, const std::uint32_t* numbers = nullptr)
        : caps_(caps), numbers_(numbers) {}

    HWY_INLINE Loaded load(Chosen<T> chosen) const {
        for (std::size_t lane = 0; numbers_ != nullptr && lane < chosen.size(); ++lane) {
            chosen[lane] = numbers_[chosen[lane]];
        }
        return {load_cap(caps_, chosen.data()), load_cap(caps_, chosen.data() + kHigh)};
    }
    static HWY_INLINE Sides sides(const Loaded& caps) {
        const Sides low = half(caps.low);
        const Sides high = half(caps.high);
        return {low.crossing | high.crossing << kHigh, low.hidden | high.hidden << kHigh};
    }
    static HWY_INLINE CapPair pair(const Loaded& caps) { return caps; }
    static HWY_INLINE SphericalCapLanes<Lanes<T>> narrow(const Loaded& caps) {
        return narrowed_cap<T>(caps.low, caps.high);
    }

  private:
    static constexpr std::size_t kHigh = kLaneCount<Lanes<T>> - kLaneCount<Doubles>;

    static HWY_INLINE Sides half(const SphericalCapLanes<Doubles>& circle) {
        const Doubles d;
        const auto zero = hn::Zero(d);
        const auto crossing = hn::Gt(circle.crossing_squared, zero);
        const auto hidden = hn::And(hn::Lt(circle.z, zero), hn::Ge(circle.cosine, zero));
        return {bits_of(d, crossing), bits_of(d, hn::AndNot(crossing, hidden))};
    }

    CapArrays caps_;
    const std::uint32_t* numbers_;
};

/// Caps of spheres, found where they are loaded.
class SphereCaps {
  public:
    using Number = float;
    struct Loaded {
        V<Floats> x, y, z, r;
    };

    explicit SphereCaps(const SphereArrays& spheres) : spheres_(spheres) {}

    HWY_INLINE Loaded load(const Chosen<float>& chosen) const {
        const Floats d;
        constexpr std::size_t kLanes = kLaneCount<Floats>;
        Loaded s;
        if (are_in_a_row(d, chosen.data())) {
            hn::LoadInterleaved3(d, &spheres_.centers[chosen.front()].x, s.x, s.y, s.z);
            s.r = hn::LoadU(d, spheres_.radii + chosen.front());
            return s;
        }
        alignas(64) std::array<float, 3 * kLanes> c;
        alignas(64) std::array<float, kLanes> own_radii;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const Vec3f& center = spheres_.centers[chosen[lane]];
            c[3 * lane] = center.x;
            c[3 * lane + 1] = center.y;
            c[3 * lane + 2] = center.z;
            own_radii[lane] = spheres_.radii[chosen[lane]];
        }
        hn::LoadInterleaved3(d, c.data(), s.x, s.y, s.z);
        s.r = hn::Load(d, own_radii.data());
        return s;
    }
    static HWY_INLINE Sides sides(const Loaded& s) {
        const Floats d;
        return {bits_of(d, hn::Lt(hn::Abs(s.z), s.r)), bits_of(d, hn::Le(s.z, hn::Neg(s.r)))};
    }
    static HWY_INLINE CapPair pair(const Loaded& s) {
        return {cap_of_sphere_in_lanes<float>(low(s.x), low(s.y), low(s.z), low(s.r)),
                cap_of_sphere_in_lanes<float>(high(s.x), high(s.y), high(s.z), high(s.r))};
    }
    /// Only what errors would be multiplied by the order needs the doubles.
    static HWY_INLINE SphericalCapLanes<Floats> narrow(const Loaded& s) {
        const Floats d;
        const auto ratios = [](V<Doubles> x, V<Doubles> y, V<Doubles> z, V<Doubles> r)
                                HWY_ATTR { return SphereRatios<float>(x, y, z, r); };
        const auto a = ratios(low(s.x), low(s.y), low(s.z), low(s.r));
        const auto b = ratios(high(s.x), high(s.y), high(s.z), high(s.r));
        const auto inverse = narrowed<float>(a.inverse, b.inverse);
        return {hn::Mul(s.x, inverse),
                hn::Mul(s.y, inverse),
                narrowed<float>(a.z, b.z),
                root(d, narrowed<float>(a.cosine_squared, b.cosine_squared)),
                hn::Min(all(d, 1), hn::Mul(s.r, inverse)),
                narrowed<float>(a.tilt_squared, b.tilt_squared),
                narrowed<float>(a.crossing_squared, b.crossing_squared)};
    }

  private:
    static HWY_INLINE V<Doubles> low(V<Floats> v) {
        return hn::PromoteTo(Doubles(), hn::LowerHalf(hn::Half<Floats>(), v));
    }
    static HWY_INLINE V<Doubles> high(V<Floats> v) {
        return hn::PromoteTo(Doubles(), hn::UpperHalf(hn::Half<Floats>(), v));
    }

    SphereArrays spheres_;
};

/// Batches of caps. Work: what is done with them.
///   Caps: StoredCaps or SphereCaps, which caps() gives;
///   kPlane: whether the horizon is the plane z = 0, kept_whole(): whether there is none at all;
///   order();
///   prepare<kCrossing>(loaded, chosen, cap): lights' caps, and what else `take` needs of them;
///   take<Bands>(cap, chosen), maybe twice for the same light, of which the second counts;
///   hide(first, bits): lights below the horizon, a bit for each from `first` on.
template <class Work>
class CapGroups {
    using Caps = typename Work::Caps;
    using T = typename Caps::Number;

  public:
    explicit CapGroups(Work& work) : work_(work), choice_(work.order()) {}

    void run(std::size_t count) {
        for (std::size_t first = 0; first < count; first += LightList::kMost) {
            run_part(first, std::min(count, first + LightList::kMost));
        }
    }

  private:
    static constexpr std::size_t kLanes = kLaneCount<Lanes<T>>;
    static constexpr std::uint32_t kFull = (1U << kLanes) - 1;
    template <bool kCrossing>
    using Bands = BandsOf<T, kCrossing, Work::kPlane>;

    void run_part(std::size_t first, std::size_t last) {
        crossing_.clear();
        uncrossed_.clear();
        fallback_[0].clear();
        fallback_[1].clear();
        for (std::size_t i = first; i < last; i += kLanes) {
            sort(i, std::min(kLanes, last - i));
        }
        run_group<true>(crossing_);
        run_group<false>(uncrossed_);
    }

    /// Lights that lie side by side and need the same are taken at once, others are put on lists.
    HWY_INLINE void sort(std::size_t first, std::size_t count) {
        Chosen<T> chosen;
        const Lanes<T> d;
        const hn::Rebind<std::uint32_t, Lanes<T>> du;
        const auto last = hn::Set(du, static_cast<std::uint32_t>(first + count - 1));
        hn::StoreU(hn::Min(row_from(d, first), last), du, chosen.data());
        const auto loaded = work_.caps().load(chosen);
        const Sides sides = work_.kept_whole() ? Sides{0, 0} : Caps::sides(loaded);
        const std::uint32_t all_lanes = (1U << count) - 1;
        const std::uint32_t crossing = sides.crossing & all_lanes;
        const std::uint32_t hidden = sides.hidden & all_lanes;
        const std::uint32_t others = all_lanes & ~(crossing | hidden);
        if (crossing == kFull) {
            take_fast<true>(loaded, chosen);
        } else if (others == kFull) {
            take_fast<false>(loaded, chosen);
        } else {
            crossing_.add_block(first, count, crossing);
            uncrossed_.add_block(first, count, others);
        }
        work_.hide(first, hidden);
    }

    template <bool kCrossing>
    HWY_INLINE void run_group(const LightList& lights) {
        lights.for_each_vector<T>([&](const Chosen<T>& chosen)
                                      HWY_ATTR { take_fast<kCrossing>(work_.caps().load(chosen), chosen); });
        fallback_[kCrossing].template for_each_vector<T>([&](const Chosen<T>& chosen) HWY_ATTR {
            ClippedCap<Lanes<T>> cap;
            work_.template prepare<kCrossing>(work_.caps().load(chosen), chosen, cap);
            work_.template take<typename Bands<kCrossing>::Fallback>(cap, chosen);
        });
    }

    /// Lanes that need other recurrences are put on a list, to be taken again.
    template <bool kCrossing>
    HWY_INLINE void take_fast(const typename Caps::Loaded& loaded, const Chosen<T>& chosen) {
        const Lanes<T> d;
        ClippedCap<Lanes<T>> cap;
        work_.template prepare<kCrossing>(loaded, chosen, cap);
        const auto fallback = choice_.template needs_fallback<kCrossing>(cap);
        if (!hn::AllTrue(d, fallback)) {
            work_.template take<typename Bands<kCrossing>::Fast>(cap, chosen);
        }
        if (!hn::AllFalse(d, fallback)) {
            fallback_[kCrossing].add_marked(d, fallback, chosen);
        }
    }

    Work& work_;
    BandChoice<T> choice_;
    LightList crossing_, uncrossed_;
    std::array<LightList, 2> fallback_;  // caps that do not cross the horizon, and caps that do
};

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
