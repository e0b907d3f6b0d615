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

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// The lights in the lanes of a vector.
template <class T>
using Chosen = std::array<std::uint32_t, kLaneCount<Lanes<T>>>;

/// Lists ascend, and only the last light of one is repeated.
template <class Indices>
HWY_INLINE bool are_in_a_row(const Indices& chosen) {
    const std::size_t last = chosen.size() - 1;
    return chosen[last] - chosen[0] == last && chosen[last] != chosen[last - 1];
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

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
