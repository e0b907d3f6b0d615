// SPDX-License-Identifier: MIT
//
// Parts of Disney's diffuse reflection in lanes (lobe_lanes-inl.h). Included once per instruction set.
#if defined(SHLIGHT_KERNELS_DISNEY_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_DISNEY_INL_H_
#undef SHLIGHT_KERNELS_DISNEY_INL_H_
#else
#define SHLIGHT_KERNELS_DISNEY_INL_H_
#endif

#include <hwy/highway.h>

#include <numbers>

#include "lobes/lambert-inl.h"
#include "shlight/lobe_shape.h"
#include "simd/gather-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

class DisneyLanes : public LambertDrawnLanes {
  public:
    /// The polynomial of the shape as a line in F_i, times π.
    template <class D>
    struct View {
        V<D> base, slope;
    };

    explicit DisneyLanes(const DisneyShape& shape) : shape_(shape) {}

    template <class D>
    HWY_INLINE View<D> view(D d, V<D> cos_o, V<D> /*parameter*/) const {
        const auto rise = fifth_power(d, cos_o);
        return {hn::MulAdd(all(d, shape_.view), rise, all(d, shape_.base)),
                hn::MulAdd(all(d, shape_.both), rise, all(d, shape_.light))};
    }
    HWY_INLINE V<Floats> value(const HalfSum& sum, V<Floats> cos_i, const View<Floats>& view) const {
        const Floats d;
        return times_pi(d, cos_i, hn::Mul(square_of(sum), all(d, 0.25)), view, 1 / std::numbers::pi);
    }
    template <class D>
    HWY_INLINE V<D> over_ndf(D d, const HalfVector<D>& half, V<D> cos_i, const View<D>& view) const {
        return times_pi(d, cos_i, hn::Mul(half.cosine, half.cosine), view, 4);
    }

  private:
    /// (1 - cosine)⁵
    template <class D>
    HWY_INLINE V<D> fifth_power(D d, V<D> cosine) const {
        const auto rest = hn::Max(hn::Sub(all(d, 1), cosine), hn::Zero(d));
        const auto square = hn::Mul(rest, rest);
        return hn::Mul(hn::Mul(square, square), rest);
    }
    /// `factor` · π · f·cos. square: cos²θ_d.
    template <class D>
    HWY_INLINE V<D> times_pi(D d, V<D> cos_i, V<D> square, const View<D>& view, double factor) const {
        auto value = hn::MulAdd(view.slope, fifth_power(d, cos_i), view.base);
        for (int i = 0; i < shape_.power; ++i) {
            value = hn::Mul(value, hn::Add(square, square));
        }
        if (shape_.sheen != 0) {
            value = hn::MulAdd(all(d, std::numbers::pi * shape_.sheen), fifth_power(d, hn::Sqrt(square)), value);
        }
        return hn::Mul(hn::Mul(all(d, factor), cos_i), value);
    }

    DisneyShape shape_;
};

template <class Function>
void with_lanes_of(const DisneyShape& shape, const Function& function) {
    function(DisneyLanes(shape));
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
