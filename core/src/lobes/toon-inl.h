// SPDX-License-Identifier: MIT
//
// Toon lobes in lanes (lobe_lanes-inl.h). Included once per instruction set.
#if defined(SHLIGHT_KERNELS_TOON_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_TOON_INL_H_
#undef SHLIGHT_KERNELS_TOON_INL_H_
#else
#define SHLIGHT_KERNELS_TOON_INL_H_
#endif

#include <hwy/highway.h>

#include <numbers>

#include <hwy/contrib/math/math-inl.h>

#include "lobes/toon.h"
#include "simd/gather-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

class ToonLanes {
  public:
    /// The sum of ω_o and the lobe's axis, whose y is 0.
    template <class D>
    struct View {
        V<D> x, z;
    };

    explicit ToonLanes(const ToonShape& shape) : cone_(shape), width_(shape.width()), glossy_(shape.glossy) {}

    template <class D>
    HWY_INLINE View<D> view(D d, V<D> cos_o, V<D> /*parameter*/) const {
        const auto one = all(d, 1);
        const auto sin_o = root(d, hn::NegMulAdd(cos_o, cos_o, one));
        return glossy_ ? View<D>{hn::Zero(d), hn::Add(cos_o, cos_o)} : View<D>{sin_o, hn::Add(cos_o, one)};
    }
    HWY_INLINE V<Floats> value(const HalfSum& sum, V<Floats> /*cos_i*/, const View<Floats>& view) const {
        return at_angle(Floats(), angle(Floats(), sum.x, sum.y, sum.z, view));
    }
    HWY_INLINE V<Floats> density(const HalfSum& sum, V<Floats> /*cos_i*/, const View<Floats>& view) const {
        const Floats d;
        return hn::IfThenElseZero(hn::Le(angle(d, sum.x, sum.y, sum.z, view), all(d, cone_.outer)), all(d, cone_.peak));
    }
    template <class D>
    HWY_INLINE V<D> over_ndf(D d, const HalfVector<D>& half, V<D> /*cos_i*/, const View<D>& view) const {
        const auto twice = hn::Add(half.cosine, half.cosine);
        const auto value =
            at_angle(d, angle(d, hn::Mul(twice, half.x), hn::Mul(twice, half.y), hn::Mul(twice, half.z), view));
        const auto across = hn::MulAdd(half.x, half.x, hn::Mul(half.y, half.y));
        const auto spread = hn::MulAdd(hn::Mul(half.z, half.z), all(d, width_ * width_), across);
        return hn::Mul(hn::Mul(value, all(d, 4 * std::numbers::pi / (width_ * width_))), hn::Mul(spread, spread));
    }

  private:
    /// Between the axis and ω_i = sum - ω_o.
    template <class D>
    HWY_INLINE V<D> angle(D d, V<D> x, V<D> y, V<D> z, const View<D>& view) const {
        const auto dx = hn::Sub(x, view.x);
        const auto dz = hn::Sub(z, view.z);
        const auto chord = hn::Sqrt(hn::MulAdd(dx, dx, hn::MulAdd(y, y, hn::Mul(dz, dz))));
        const auto half = hn::Asin(d, hn::Min(hn::Mul(chord, all(d, 0.5)), all(d, 1)));
        return hn::Add(half, half);
    }
    template <class D>
    HWY_INLINE V<D> at_angle(D d, V<D> angle) const {
        const auto beyond = hn::Max(hn::Sub(angle, all(d, cone_.inner)), hn::Zero(d));
        const auto value = hn::NegMulAdd(beyond, all(d, cone_.peak / cone_.fade), all(d, cone_.peak));
        return hn::IfThenElseZero(hn::Le(angle, all(d, cone_.outer)), hn::Max(value, hn::Zero(d)));
    }

    ToonCone cone_;
    double width_;
    bool glossy_;
};

template <class Function>
void with_lanes_of(const ToonShape& shape, const Function& function) {
    function(ToonLanes(shape));
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
