// SPDX-License-Identifier: MIT
#include "caps/cap_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "caps/cap_plane_shading.cpp"
#include <hwy/foreach_target.h>
// Highway's vocabulary, and what is compiled once per instruction set, come after it.
#include <hwy/highway.h>

#include <array>
#include <cstddef>

#include "caps/cap_plane-inl.h"
#include "caps/cap_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {
namespace {

/// Multiplies with the terms of one lobe that all lights share.
class LobeSink {
    using D = Floats;

  public:
    LobeSink(std::size_t order, const float* terms, float* values) : order_(order), values_(values) {
        for (std::size_t k = 0; k < order * (order + 1) / 2; ++k) {
            hn::Store(hn::Set(D(), terms[k]), D(), terms_.data() + k * kLaneCount<D>);
        }
    }

    std::size_t order() const { return order_; }
    void hide(std::size_t i) const { values_[i] = 0; }

    template <class Bands>
    HWY_NOINLINE void take(const CapLanes<D>& cap, const Chosen<float>& chosen) const {
        ShadingVisitor<float> visit(cap, order_, terms_.data());
        solve_bands(Bands(cap, order_), order_, visit);
        alignas(64) std::array<float, kLaneCount<D>> sums;
        hn::Store(visit.sum(), D(), sums.data());
        for (std::size_t lane = 0; lane < sums.size(); ++lane) {
            values_[chosen[lane]] = sums[lane];
        }
    }

  private:
    std::size_t order_;
    float* values_;
    alignas(64) std::array<float, kCosineMax * kLaneCount<D>> terms_;
};

void shade_spheres_float(const Vec3<float>* centers, const float* radii, std::size_t count, std::size_t order,
                         const float* terms, float* values) {
    run_batch<float>(SphereSource<float>{centers, radii}, count, true, LobeSink(order, terms, values));
}

}  // namespace
}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shlight {

HWY_EXPORT(shade_spheres_float);

void shade_spheres_on_plane(const Vec3<float>* centers, const float* radii, std::size_t count, const float* lobe_terms,
                            int order, float* values) {
    HWY_DYNAMIC_DISPATCH(shade_spheres_float)
    (centers, radii, count, static_cast<std::size_t>(order), lobe_terms, values);
}

}  // namespace shlight
#endif
