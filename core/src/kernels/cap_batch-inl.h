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

#include "kernels/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight {
namespace HWY_NAMESPACE {

/// The lights in the lanes of a vector.
template <class T>
using Chosen = std::array<std::uint32_t, kLaneCount<Lanes<T>>>;

/// Lists ascend, and only the last light of one is repeated.
template <class Indices>
HWY_INLINE bool are_in_a_row(const Indices& chosen) {
    const std::size_t last = chosen.size() - 1;
    return chosen[last] - chosen[0] == last && chosen[last] != chosen[last - 1];
}

/// Lights of a chunk that have the same needs.
class LightList {
  public:
    static constexpr std::size_t kMost = 512;

    /// Adds i, or leaves it: without a branch.
    HWY_INLINE void add_if(bool wanted, std::size_t i) {
        indices_[count_] = static_cast<std::uint32_t>(i);
        count_ += wanted ? 1 : 0;
    }
    /// Adds the marked lanes; the last lights of a vector may be the same one.
    template <class D, class T = Scalar<D>>
    HWY_INLINE void add_marked(D d, M<D> marked, const Chosen<T>& chosen) {
        alignas(64) std::array<T, kLaneCount<D>> marks;
        hn::Store(hn::IfThenElseZero(marked, all(d, 1)), d, marks.data());
        for (std::size_t lane = 0; lane < marks.size(); ++lane) {
            add_if(marks[lane] != 0 && (lane == 0 || chosen[lane] != chosen[lane - 1]), chosen[lane]);
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
    std::array<std::uint32_t, kMost + 1> indices_;
    std::size_t count_ = 0;
};

}  // namespace HWY_NAMESPACE
}  // namespace shlight
HWY_AFTER_NAMESPACE();

#endif
