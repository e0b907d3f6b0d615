// SPDX-License-Identifier: MIT
//
// GGX lobes in lanes (lobe_lanes-inl.h). Included once per instruction set.
#if defined(SHLIGHT_KERNELS_GGX_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_GGX_INL_H_
#undef SHLIGHT_KERNELS_GGX_INL_H_
#else
#define SHLIGHT_KERNELS_GGX_INL_H_
#endif

#include <hwy/highway.h>

#include <numbers>

#include "shlight/lobe_shape.h"
#include "simd/gather-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// Fresnel factor at ω_i·h = cosine, for shapes whose factor is not 1.
template <Fresnel kFresnel, class D>
HWY_INLINE V<D> fresnel_in_lanes(D d, double ior, V<D> cosine) {
    const auto one = all(d, 1);
    const auto edge = hn::Sub(one, hn::Min(cosine, one));
    if constexpr (kFresnel == Fresnel::schlick) {
        const auto square = hn::Mul(edge, edge);
        return hn::Mul(hn::Mul(square, square), edge);
    }
    if constexpr (kFresnel == Fresnel::dip) {
        const auto square = hn::Mul(edge, edge);
        return hn::Mul(hn::Mul(hn::Mul(square, square), square), hn::Sub(one, edge));
    }
    // The exact curve minus its value at normal incidence, (a² (1 + b²) - 2 a_0²) / 2 with b = 1 + f, a = a_0 + e,
    // where f and e are multiples of `edge`: no difference of nearly equal numbers is left.
    const double head_on = (ior - 1) / (ior + 1);
    const auto c = hn::Sub(one, edge);
    const auto bent = hn::Mul(edge, hn::Sub(all(d, 2), edge));  // 1 - c²
    const auto g = hn::Sqrt(hn::Sub(all(d, ior * ior), bent));
    const auto lag = hn::Div(bent, hn::Add(g, all(d, ior)));  // ior - g
    const auto e = hn::Div(hn::Mul(all(d, 2 / (ior + 1)), hn::MulSub(all(d, ior), edge, lag)), hn::Add(g, c));
    const auto f = hn::Div(hn::Mul(all(d, -2), bent), hn::MulAdd(c, hn::Sub(g, c), one));
    const auto a = hn::Add(all(d, head_on), e);
    const auto parallel = hn::Mul(hn::Mul(a, a), hn::MulAdd(hn::Mul(f, f), all(d, 0.5), f));
    const auto rise = hn::MulAdd(e, hn::Add(a, all(d, head_on)), parallel);
    return hn::Max(hn::Zero(d), hn::Mul(rise, all(d, 1 / (1 - head_on * head_on))));
}

/// GGX with one Fresnel factor. View holds the numbers that change from view to view.
template <Fresnel kFresnel>
class GgxLanes {
  public:
    template <class D>
    struct View {
        V<D> cosine, alpha2, masking;  // cosθ_o, α², √(α² + (1-α²) cos²θ_o)
    };

    /// The shape's alpha is not used; view() takes one for each lane.
    explicit GgxLanes(const GgxShape& shape) : ior_(shape.ior) {}

    template <class D>
    HWY_INLINE View<D> view(D d, V<D> cos_o, V<D> alpha) const {
        const auto alpha2 = hn::Mul(alpha, alpha);
        return {cos_o, alpha2, masking(d, alpha2, cos_o)};
    }

    HWY_INLINE V<Floats> value(const HalfSum& sum, V<Floats> cos_i, const View<Floats>& view) const {
        const Floats d;
        const auto visibility =
            hn::Div(cos_i, hn::MulAdd(view.cosine, masking(d, view.alpha2, cos_i), hn::Mul(cos_i, view.masking)));
        // |ω_i + ω_o| is twice ω_i·h.
        const auto square = hn::MulAdd(sum.x, sum.x, hn::MulAdd(sum.y, sum.y, hn::Mul(sum.z, sum.z)));
        return with_fresnel(d, hn::Mul(half_distribution(sum, view), visibility),
                            [&] HWY_ATTR { return hn::Mul(hn::Sqrt(square), all(d, 0.5)); });
    }

    /// Density per solid angle at which GgxShape::sample draws this direction.
    HWY_INLINE V<Floats> density(const HalfSum& sum, V<Floats> /*cos_i*/, const View<Floats>& view) const {
        return hn::Div(half_distribution(sum, view), hn::Add(view.cosine, view.masking));
    }

    /// F G₂ / cosθ_o.
    template <class D>
    HWY_INLINE V<D> over_ndf(D d, const HalfVector<D>& half, V<D> cos_i, const View<D>& view) const {
        const auto visibility = hn::Div(hn::Add(cos_i, cos_i), hn::MulAdd(view.cosine, masking(d, view.alpha2, cos_i),
                                                                          hn::Mul(cos_i, view.masking)));
        return with_fresnel(d, visibility, [&] HWY_ATTR { return half.cosine; });
    }

    /// ∂ ln(f·cos) / ∂α, f·cos being a product of D(h), 1 / (α² h_z² + h_x² + h_y²)² but for α², and of the
    /// visibility.
    template <class D>
    HWY_INLINE V<D> relative_by_alpha(D d, V<D> alpha, const HalfVector<D>& half, V<D> cos_i,
                                      const View<D>& view) const {
        const auto one = all(d, 1);
        const auto across = hn::MulAdd(half.x, half.x, hn::Mul(half.y, half.y));
        const auto up = hn::Mul(view.alpha2, hn::Mul(half.z, half.z));
        const auto peak = hn::Div(hn::Sub(across, up), hn::Add(across, up));  // α/2 ∂ ln D / ∂α
        const auto masked = masking(d, view.alpha2, cos_i);
        const auto change =
            hn::MulAdd(hn::Div(view.cosine, masked), hn::NegMulAdd(cos_i, cos_i, one),
                       hn::Mul(hn::Div(cos_i, view.masking), hn::NegMulAdd(view.cosine, view.cosine, one)));
        const auto all_masked = hn::MulAdd(view.cosine, masked, hn::Mul(cos_i, view.masking));
        return hn::Sub(hn::Div(hn::Add(peak, peak), alpha), hn::Mul(alpha, hn::Div(change, all_masked)));
    }

  private:
    /// D(h) / 2 = α² / (2π) · (|h|² / (α² h_z² + h_x² + h_y²))².
    HWY_INLINE V<Floats> half_distribution(const HalfSum& sum, const View<Floats>& view) const {
        const Floats d;
        const auto across = hn::MulAdd(sum.x, sum.x, hn::Mul(sum.y, sum.y));
        const auto up = hn::Mul(sum.z, sum.z);
        const auto sharpness = hn::Div(hn::Add(across, up), hn::MulAdd(view.alpha2, up, across));
        // Multiplied in this order a narrow lobe stays within a float's range.
        const auto peak = hn::Mul(view.alpha2, all(d, 1 / (2 * std::numbers::pi)));
        return hn::Mul(hn::Mul(peak, sharpness), sharpness);
    }

    /// √(α² + (1-α²) cos²θ).
    template <class D>
    static HWY_INLINE V<D> masking(D d, V<D> alpha2, V<D> cosine) {
        return hn::Sqrt(hn::MulAdd(hn::Mul(hn::Sub(all(d, 1), alpha2), cosine), cosine, alpha2));
    }

    template <class D, class CosineOfHalf>
    HWY_INLINE V<D> with_fresnel(D d, V<D> value, const CosineOfHalf& cos_half) const {
        if constexpr (kFresnel == Fresnel::one) {
            return value;
        } else {
            return hn::Mul(value, fresnel_in_lanes<kFresnel>(d, ior_, cos_half()));
        }
    }

    double ior_;
};

/// ∂(f·cos)/∂α of a GGX lobe in place of f·cos, for integrals along a boundary.
template <Fresnel kFresnel>
class GgxByAlphaLanes {
  public:
    template <class D>
    struct View {
        typename GgxLanes<kFresnel>::template View<D> own;
        V<D> alpha;
    };

    explicit GgxByAlphaLanes(const GgxShape& shape) : lobe_(shape) {}

    template <class D>
    HWY_INLINE View<D> view(D d, V<D> cos_o, V<D> alpha) const {
        return {lobe_.view(d, cos_o, alpha), alpha};
    }
    template <class D>
    HWY_INLINE V<D> over_ndf(D d, const HalfVector<D>& half, V<D> cos_i, const View<D>& view) const {
        return hn::Mul(lobe_.over_ndf(d, half, cos_i, view.own),
                       lobe_.relative_by_alpha(d, view.alpha, half, cos_i, view.own));
    }

  private:
    GgxLanes<kFresnel> lobe_;
};

/// Calls function(lanes) with Lanes<the shape's Fresnel factor>.
template <template <Fresnel> class Lanes, class Function>
void with_fresnel_of(const GgxShape& shape, const Function& function) {
    switch (shape.fresnel) {
        case Fresnel::one:
            return function(Lanes<Fresnel::one>(shape));
        case Fresnel::schlick:
            return function(Lanes<Fresnel::schlick>(shape));
        case Fresnel::dip:
            return function(Lanes<Fresnel::dip>(shape));
        case Fresnel::dielectric:
            return function(Lanes<Fresnel::dielectric>(shape));
    }
}

template <class Function>
void with_lanes_by_alpha(const GgxShape& shape, const Function& function) {
    with_fresnel_of<GgxByAlphaLanes>(shape, function);
}

template <class Function>
void with_lanes_of(const GgxShape& shape, const Function& function) {
    with_fresnel_of<GgxLanes>(shape, function);
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
