// SPDX-License-Identifier: MIT
//
// Loads from arrays into lanes: from consecutive places, by index, or one value for all. Included once per instruction
// set.
#if defined(SHLIGHT_KERNELS_GATHER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_GATHER_INL_H_
#undef SHLIGHT_KERNELS_GATHER_INL_H_
#else
#define SHLIGHT_KERNELS_GATHER_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// Half a vector of floats: as many as Doubles has lanes.
using HalfFloats = hn::Rebind<float, Doubles>;

/// Stores the first `count` lanes.
template <class D>
HWY_INLINE void store_some(D d, V<D> value, std::size_t count, Scalar<D>* out) {
    if (count == kLaneCount<D>) {
        hn::StoreU(value, d, out);
        return;
    }
    alignas(64) std::array<Scalar<D>, kLaneCount<D>> buffer;
    hn::Store(value, d, buffer.data());
    std::copy_n(buffer.begin(), count, out);
}

/// Two vectors of doubles: as many as Floats has lanes.
struct DoublePair {
    V<Doubles> low, high;
};

HWY_INLINE V<Floats> rounded(const DoublePair& pair) {
    const HalfFloats half;
    return hn::Combine(Floats(), hn::DemoteTo(half, pair.high), hn::DemoteTo(half, pair.low));
}

HWY_INLINE V<Floats> rounded_sum(const DoublePair& a, const DoublePair& b) {
    return rounded({hn::Add(a.low, b.low), hn::Add(a.high, b.high)});
}

/// Loads consecutive values from an index on.
class Contiguous {
  public:
    explicit Contiguous(std::size_t first) : first_(first) {}
    DoublePair pair(const double* values) const {
        const Doubles d;
        return {hn::LoadU(d, values + first_), hn::LoadU(d, values + first_ + kLaneCount<Doubles>)};
    }
    V<Floats> load(const double* values) const { return rounded(pair(values)); }

  private:
    std::size_t first_;
};

/// Loads the values that a list of indices names. Lanes beyond the list's end repeat its last value.
class Gather {
  public:
    Gather(const std::uint32_t* list, std::size_t count) {
        const hn::RebindToSigned<Floats> di;
        const hn::RebindToUnsigned<Floats> du;
        if (count >= kLaneCount<Floats>) {
            index_ = hn::BitCast(di, hn::LoadU(du, list));
            return;
        }
        alignas(64) std::array<std::uint32_t, kLaneCount<Floats>> padded;
        std::fill(std::copy_n(list, count, padded.begin()), padded.end(), list[count - 1]);
        index_ = hn::BitCast(di, hn::Load(du, padded.data()));
    }
    DoublePair pair(const double* values) const {
        const Doubles d;
        const hn::RebindToSigned<Doubles> d64;
        const hn::Rebind<std::int32_t, Doubles> d32;
        return {hn::GatherIndex(d, values, hn::PromoteTo(d64, hn::LowerHalf(d32, index_))),
                hn::GatherIndex(d, values, hn::PromoteTo(d64, hn::UpperHalf(d32, index_)))};
    }
    V<Floats> load(const double* values) const { return rounded(pair(values)); }
    V<Floats> load(const float* values) const { return hn::GatherIndex(Floats(), values, index_); }

  private:
    V<hn::RebindToSigned<Floats>> index_;
};

/// Loads the first value into all lanes, for lists whose indices are all 0.
class Broadcast {
  public:
    Broadcast(const std::uint32_t*, std::size_t) {}
    DoublePair pair(const double* values) const {
        const auto value = hn::Set(Doubles(), *values);
        return {value, value};
    }
    V<Floats> load(const double* values) const { return all(Floats(), *values); }
    V<Floats> load(const float* values) const { return hn::Set(Floats(), *values); }
};

/// ω_i + ω_o. Near the mirror direction x and y are small differences, whose digits the caller must keep.
struct HalfSum {
    V<Floats> x, y, z;
};
HWY_INLINE V<Floats> square_of(const HalfSum& sum) {
    return hn::MulAdd(sum.x, sum.x, hn::MulAdd(sum.y, sum.y, hn::Mul(sum.z, sum.z)));
}

/// The half vector, unit, and its cosine with ω_i and ω_o.
template <class D>
struct HalfVector {
    V<D> x, y, z, cosine;
};

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
