// SPDX-License-Identifier: MIT
//
// f·cos of GGX lobes in lanes. Included once per instruction set.
#if defined(SHLIGHT_KERNELS_GGX_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_GGX_INL_H_
#undef SHLIGHT_KERNELS_GGX_INL_H_
#else
#define SHLIGHT_KERNELS_GGX_INL_H_
#endif

#include <hwy/highway.h>

#include <numbers>

#include "shlight/lobe_shape.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// F at ω_i·h = cosine: fresnel_factor() in lanes.
template <Fresnel kFresnel, class D>
HWY_INLINE V<D> fresnel_in_lanes(D d, double ior, V<D> cosine) {
    const auto one = all(d, 1);
    if constexpr (kFresnel == Fresnel::one) {
        return one;
    }
    const auto edge = hn::Sub(one, hn::Min(cosine, one));
    if constexpr (kFresnel == Fresnel::schlick) {
        const auto square = hn::Mul(edge, edge);
        return hn::Mul(hn::Mul(square, square), edge);
    }
    // The exact curve less its value head-on, (a² (1 + b²) - 2 a_0²) / 2 with b = 1 + f, a = a_0 + e and f and e as
    // multiples of `edge`: no difference of nearly equal numbers is left.
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
    return hn::Mul(rise, all(d, 1 / (1 - head_on * head_on)));
}

/// Directions' sums ω_i + ω_o, from which all but the masking follows: near the mirror direction x and y are small
/// differences, which the caller forms with care.
struct HalfSum {
    V<Floats> x, y, z;
};

/// One lobe; kFresnel as in its shape.
template <Fresnel kFresnel>
class GgxLanes {
  public:
    explicit GgxLanes(const GgxShape& shape)
        : alpha2_(static_cast<float>(shape.alpha * shape.alpha)), ior_(shape.ior) {}

    /// √(α² + (1-α²) cos²θ).
    V<Floats> masking(V<Floats> cosine) const {
        const Floats d;
        return hn::Sqrt(hn::MulAdd(hn::Mul(all(d, 1 - double{alpha2_}), cosine), cosine, hn::Set(d, alpha2_)));
    }

    /// f·cos, or 0 where a direction is not above the horizon. masking_o: of cos_o.
    /// The bell is α² h_z² + h_x² + h_y², all over |h|².
    V<Floats> value(const HalfSum& sum, V<Floats> cos_i, V<Floats> cos_o, V<Floats> masking_o) const {
        const Floats d;
        const auto across = hn::MulAdd(sum.x, sum.x, hn::Mul(sum.y, sum.y));
        const auto up = hn::Mul(sum.z, sum.z);
        const auto square = hn::Add(across, up);
        const auto sharpness = hn::Div(square, hn::MulAdd(hn::Set(d, alpha2_), up, across));
        const auto visibility = hn::Div(cos_i, hn::MulAdd(cos_o, masking(cos_i), hn::Mul(cos_i, masking_o)));
        // In this order nothing of a narrow lobe leaves a float's range.
        auto result = hn::Mul(hn::Mul(hn::Mul(all(d, double{alpha2_} / (2 * std::numbers::pi)), sharpness), sharpness),
                              visibility);
        if constexpr (kFresnel != Fresnel::one) {
            // |ω_i + ω_o| is twice the cosine of half the angle between them.
            result = hn::Mul(result, fresnel_in_lanes<kFresnel>(d, ior_, hn::Mul(hn::Sqrt(square), all(d, 0.5))));
        }
        return hn::IfThenElseZero(hn::Gt(hn::Min(cos_i, cos_o), hn::Zero(d)), result);
    }

  private:
    float alpha2_;
    double ior_;
};

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
