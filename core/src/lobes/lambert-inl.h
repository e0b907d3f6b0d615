// SPDX-License-Identifier: MIT
//
// Lambert's lobe in lanes (lobe_lanes-inl.h). Included once per instruction set.
#if defined(SHLIGHT_KERNELS_LAMBERT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_LAMBERT_INL_H_
#undef SHLIGHT_KERNELS_LAMBERT_INL_H_
#else
#define SHLIGHT_KERNELS_LAMBERT_INL_H_
#endif

#include <hwy/highway.h>

#include <numbers>

#include "shlight/lobe_shape.h"
#include "simd/gather-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// Lanes of lobes whose rays are drawn from Lambert's.
class LambertDrawnLanes {
  public:
    template <class View>
    HWY_INLINE V<Floats> density(const HalfSum& /*sum*/, V<Floats> cos_i, const View& /*view*/) const {
        return hn::Mul(cos_i, all(Floats(), 1 / std::numbers::pi));
    }
};

class LambertLanes : public LambertDrawnLanes {
  public:
    template <class D>
    struct View {};

    template <class D>
    HWY_INLINE View<D> view(D /*d*/, V<D> /*cos_o*/, V<D> /*alpha*/) const {
        return {};
    }
    HWY_INLINE V<Floats> value(const HalfSum& /*sum*/, V<Floats> cos_i, const View<Floats>& /*view*/) const {
        return hn::Mul(cos_i, all(Floats(), 1 / std::numbers::pi));
    }
    template <class D>
    HWY_INLINE V<D> over_ndf(D d, const HalfVector<D>& /*half*/, V<D> cos_i, const View<D>& /*view*/) const {
        return hn::Mul(cos_i, all(d, 4));
    }
};

template <class Function>
void with_lanes_of(const LambertShape& /*shape*/, const Function& function) {
    function(LambertLanes());
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
