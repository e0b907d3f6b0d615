// SPDX-License-Identifier: MIT
//
// Rough diffuse lobes in lanes (lobe_lanes-inl.h). Included once per instruction set.
#if defined(SHLIGHT_KERNELS_ROUGH_DIFFUSE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_ROUGH_DIFFUSE_INL_H_
#undef SHLIGHT_KERNELS_ROUGH_DIFFUSE_INL_H_
#else
#define SHLIGHT_KERNELS_ROUGH_DIFFUSE_INL_H_
#endif

#include <hwy/highway.h>

#include <numbers>

#include <hwy/contrib/math/math-inl.h>

#include "lobes/lambert-inl.h"
#include "lobes/rough_diffuse.h"
#include "shlight/lobe_shape.h"
#include "simd/gather-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

template <Diffuse kKind>
class DiffuseLanes : public LambertDrawnLanes {
  public:
    template <class D>
    struct View {
        V<D> cosine, alpha2;
    };

    template <class D>
    HWY_INLINE View<D> view(D d, V<D> cos_o, V<D> /*alpha*/) const {
        const auto square = hn::Max(hn::Mul(cos_o, cos_o), all(d, 1e-12));
        const auto tilt = hn::Div(hn::Sub(all(d, 1), square), square);
        return {cos_o, hn::Min(hn::Mul(all(d, kBumpShare), hn::Max(tilt, hn::Zero(d))), all(d, 1))};
    }
    HWY_INLINE V<Floats> value(const HalfSum& sum, V<Floats> cos_i, const View<Floats>& view) const {
        const Floats d;
        return times_pi(d, cos_i, hn::MulAdd(square_of(sum), all(d, 0.5), all(d, -1)), view, 1 / std::numbers::pi);
    }
    template <class D>
    HWY_INLINE V<D> over_ndf(D d, const HalfVector<D>& half, V<D> cos_i, const View<D>& view) const {
        return times_pi(d, cos_i, hn::MulAdd(hn::Add(half.cosine, half.cosine), half.cosine, all(d, -1)), view, 4);
    }

  private:
    /// `factor` · π · f·cos. between: ω_i·ω_o.
    template <class D>
    HWY_INLINE V<D> times_pi(D d, V<D> cos_i, V<D> between, const View<D>& view, double factor) const {
        const auto zero = hn::Zero(d);
        const auto one = all(d, 1);
        const double pi = std::numbers::pi;
        if constexpr (kKind == Diffuse::oren_nayar) {
            const auto t = hn::NegMulAdd(cos_i, view.cosine, between);
            const auto scaled = hn::IfThenElse(hn::Gt(t, zero), hn::Div(t, hn::Max(cos_i, view.cosine)), t);
            return hn::Mul(hn::Mul(all(d, pi * factor), cos_i), hn::Add(one, scaled));
        } else if constexpr (kKind == Diffuse::bumped_ggx) {
            const auto square = hn::Mul(between, between);
            const auto rest = hn::Mul(view.alpha2, hn::Max(hn::Sub(one, square), zero));
            const auto below = hn::Add(between, hn::Sqrt(hn::Add(square, rest)));
            const auto shadow = hn::Div(hn::Add(between, between), hn::Max(below, all(d, 1e-12)));
            return hn::IfThenElseZero(hn::Gt(between, zero), hn::Mul(hn::Mul(all(d, factor), cos_i), shadow));
        } else if constexpr (kKind == Diffuse::bumped_cubic) {
            const auto least = hn::Max(hn::Mul(cos_i, view.cosine), all(d, 1e-12));
            const auto g = hn::Min(hn::Div(hn::Max(between, zero), least), one);
            const auto shadow = hn::Mul(g, hn::MulAdd(g, hn::Sub(one, g), one));
            return hn::Mul(hn::Mul(all(d, factor), cos_i), shadow);
        } else {
            const auto cosine = hn::Min(cos_i, one);
            const auto sine = hn::Sqrt(hn::Max(zero, hn::NegMulAdd(cosine, cosine, one)));
            const auto angle = hn::Acos(d, cosine);
            const auto cube = hn::Mul(hn::Mul(sine, sine), sine);
            const auto slope = hn::Div(sine, hn::Max(cosine, all(d, kGrazingLoss)));
            const auto g = hn::MulAdd(sine, hn::NegMulAdd(sine, cosine, hn::Sub(angle, all(d, 2.0 / 3))),
                                      hn::Mul(hn::Mul(all(d, 2.0 / 3), slope), hn::Sub(one, cube)));
            const auto loss =
                hn::IfThenElse(hn::Lt(cosine, all(d, kGrazingLoss)), cosine, hn::Sub(all(d, pi / 2 - 2.0 / 3), g));
            return hn::Mul(hn::Mul(all(d, pi * factor), cos_i), hn::Max(loss, zero));
        }
    }
};

template <class Function>
void with_lanes_of(const DiffuseShape& shape, const Function& function) {
    switch (shape.kind) {
        case Diffuse::oren_nayar:
            return function(DiffuseLanes<Diffuse::oren_nayar>());
        case Diffuse::oren_nayar_loss:
            return function(DiffuseLanes<Diffuse::oren_nayar_loss>());
        case Diffuse::bumped_ggx:
            return function(DiffuseLanes<Diffuse::bumped_ggx>());
        case Diffuse::bumped_cubic:
            return function(DiffuseLanes<Diffuse::bumped_cubic>());
    }
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
