// SPDX-License-Identifier: MIT
#include "regions/cap_kernels.h"

#include <hwy/cache_control.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "regions/cap_rows.cpp"
#include <hwy/foreach_target.h>
// Highway's headers and code that is compiled once per instruction set follow foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "regions/cap_groups-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

template <class Bands, class T>
HWY_NOINLINE void write_rows(const ClippedCap<Lanes<T>>& cap, std::size_t order, const RowPointers<T>& rows,
                             Output output) {
    CoefficientVisitor<T> visit(cap, order, rows, output);
    solve_bands(Bands(cap, order), order, visit);
    visit.finish();
}

/// Writes coefficients to rows, order² values for each light.
template <class Source>
class CapRows {
    using T = typename Source::Number;

  public:
    using Caps = Source;
    static constexpr bool kPlane = true;

    CapRows(const Caps& caps, int order, bool clip, T* rows, Output output)
        : caps_(caps), order_(static_cast<std::size_t>(order)), clip_(clip), rows_(rows), output_(output) {}

    std::size_t order() const { return order_; }
    bool kept_whole() const { return !clip_; }
    const Caps& caps() const { return caps_; }
    void hide(std::size_t first, std::uint32_t bits) const {
        for (; bits != 0; bits >>= 1, ++first) {
            if ((bits & 1U) != 0) {
                std::fill_n(row(first), order_ * order_, T(0));
            }
        }
    }

    template <bool kCrossing>
    HWY_INLINE void prepare(const typename Caps::Loaded& loaded, const Chosen<T>& /*chosen*/,
                            ClippedCap<Lanes<T>>& cap) const {
        cap = cap_at_plane<kCrossing>(Lanes<T>(), Caps::narrow(loaded), !clip_);
    }

    template <class Bands>
    HWY_INLINE void take(const ClippedCap<Lanes<T>>& cap, const Chosen<T>& chosen) const {
        RowPointers<T> rows;
        std::transform(chosen.begin(), chosen.end(), rows.begin(), [this](std::size_t i) { return row(i); });
        write_rows<Bands, T>(cap, order_, rows, output_);
    }

  private:
    T* row(std::size_t i) const { return rows_ + i * order_ * order_; }

    Caps caps_;
    std::size_t order_;
    bool clip_;
    T* rows_;
    Output output_;
};

template <class Caps, class T>
void rows_of(const Caps& caps, std::size_t count, int order, bool clip, T* rows, Output output) {
    CapRows<Caps> work(caps, order, clip, rows, output);
    CapGroups<CapRows<Caps>>(work).run(count);
    if (output == Output::streamed) {
        hwy::FlushStream();
    }
}

void cap_rows_float(const CapArrays& caps, std::size_t count, int order, bool clip, float* rows, Output output) {
    rows_of(StoredCaps<float>(caps), count, order, clip, rows, output);
}
void cap_rows_double(const CapArrays& caps, std::size_t count, int order, bool clip, double* rows, Output output) {
    rows_of(StoredCaps<double>(caps), count, order, clip, rows, output);
}
void sphere_rows(const SphereArrays& spheres, std::size_t count, int order, bool clip, float* rows, Output output) {
    rows_of(SphereCaps(spheres), count, order, clip, rows, output);
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(cap_rows_float);
HWY_EXPORT(cap_rows_double);
HWY_EXPORT(sphere_rows);

void cap_rows(const CapArrays& caps, std::size_t count, int order, bool clip, float* rows, Output output) {
    HWY_DYNAMIC_DISPATCH(cap_rows_float)(caps, count, order, clip, rows, output);
}
void cap_rows(const CapArrays& caps, std::size_t count, int order, bool clip, double* rows, Output output) {
    HWY_DYNAMIC_DISPATCH(cap_rows_double)(caps, count, order, clip, rows, output);
}
void cap_rows(const SphereArrays& spheres, std::size_t count, int order, bool clip, float* rows, Output output) {
    HWY_DYNAMIC_DISPATCH(sphere_rows)(spheres, count, order, clip, rows, output);
}

}  // namespace shlight
#endif
