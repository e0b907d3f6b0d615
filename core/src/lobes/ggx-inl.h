// SPDX-License-Identifier: MIT
//
// Lobes of microfacets in lanes (lobe_lanes-inl.h). Included once per instruction set.
#if defined(SHLIGHT_KERNELS_GGX_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_GGX_INL_H_
#undef SHLIGHT_KERNELS_GGX_INL_H_
#else
#define SHLIGHT_KERNELS_GGX_INL_H_
#endif

#include <hwy/highway.h>

#include <cmath>
#include <numbers>

#include <hwy/contrib/math/math-inl.h>

#include "lobes/microfacets.h"
#include "shlight/lobe_shape.h"
#include "simd/gather-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// 1/√x of normal floats, to about 1e-13: a float's digits, refined twice by Newton's method.
template <class D>
HWY_INLINE V<D> inverse_root(D d, V<D> x) {
    const hn::Rebind<float, D> floats;
    auto y = hn::PromoteTo(d, hn::ApproximateReciprocalSqrt(hn::DemoteTo(floats, x)));
    const auto half = hn::Mul(x, all(d, 0.5));
    for (int step = 0; step < 2; ++step) {
        y = hn::Mul(y, hn::NegMulAdd(hn::Mul(half, y), y, all(d, 1.5)));
    }
    return y;
}

/// Fresnel factor at ω_i·h = cosine, for shapes whose factor is not 1.
template <Fresnel kFresnel, class D>
HWY_INLINE V<D> fresnel_in_lanes(D d, double ior, V<D> cosine) {
    const auto one = all(d, 1);
    const auto edge = hn::Sub(one, hn::Min(cosine, one));
    if constexpr (kFresnel == Fresnel::linear) {
        return edge;
    }
    if constexpr (kFresnel == Fresnel::broad_dip) {
        return hn::Mul(hn::Mul(edge, edge), hn::Sub(one, edge));
    }
    if constexpr (kFresnel == Fresnel::schlick) {
        const auto square = hn::Mul(edge, edge);
        return hn::Mul(hn::Mul(square, square), edge);
    }
    if constexpr (kFresnel == Fresnel::dip || kFresnel == Fresnel::wide_dip || kFresnel == Fresnel::narrow_dip) {
        const auto cube = hn::Mul(hn::Mul(edge, edge), edge);
        const auto sixth = kFresnel == Fresnel::wide_dip ? cube : hn::Mul(cube, cube);
        return hn::Mul(kFresnel == Fresnel::narrow_dip ? hn::Mul(sixth, sixth) : sixth, hn::Sub(one, edge));
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

/// The shape's Fresnel factor.
template <class D>
HWY_INLINE V<D> fresnel_of(D d, const GgxShape& shape, V<D> cosine) {
    switch (shape.fresnel) {
        case Fresnel::one:
            break;
        case Fresnel::schlick:
            return fresnel_in_lanes<Fresnel::schlick>(d, shape.ior, cosine);
        case Fresnel::dip:
            return fresnel_in_lanes<Fresnel::dip>(d, shape.ior, cosine);
        case Fresnel::wide_dip:
            return fresnel_in_lanes<Fresnel::wide_dip>(d, shape.ior, cosine);
        case Fresnel::narrow_dip:
            return fresnel_in_lanes<Fresnel::narrow_dip>(d, shape.ior, cosine);
        case Fresnel::broad_dip:
            return fresnel_in_lanes<Fresnel::broad_dip>(d, shape.ior, cosine);
        case Fresnel::linear:
            return fresnel_in_lanes<Fresnel::linear>(d, shape.ior, cosine);
        case Fresnel::dielectric:
            return fresnel_in_lanes<Fresnel::dielectric>(d, shape.ior, cosine);
    }
    return all(d, 1);
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
        const auto square = square_of(sum);
        return with_fresnel(d, hn::Mul(half_distribution(sum, view), visibility),
                            [&]() HWY_ATTR { return hn::Mul(hn::Sqrt(square), all(d, 0.5)); });
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
        return with_fresnel(d, visibility, [&]() HWY_ATTR { return half.cosine; });
    }

    /// ∂(f·cos)/∂α as over_ndf() is f·cos, of F = 1; steepness: (h_⊥² - α² h_z²) / (h_⊥² + α² h_z²).
    template <class D>
    static HWY_INLINE V<D> over_ndf_by_alpha(D d, V<D> alpha, V<D> steepness, V<D> cos_i, const View<D>& view) {
        const auto square = masking_squared(d, view.alpha2, cos_i);
        const auto inverse = inverse_root(d, square);
        const auto across_o = hn::Div(hn::NegMulAdd(view.cosine, view.cosine, all(d, 1)), view.masking);
        const auto across_i = hn::Mul(view.cosine, hn::NegMulAdd(cos_i, cos_i, all(d, 1)));
        const auto both = hn::MulAdd(view.cosine, hn::Mul(square, inverse), hn::Mul(cos_i, view.masking));
        const auto over_both = hn::Div(all(d, 1), both);
        const auto change = hn::MulAdd(across_i, inverse, hn::Mul(cos_i, across_o));
        const auto peak = hn::Mul(hn::Div(all(d, 2), alpha), steepness);
        return hn::Mul(hn::Mul(hn::Add(cos_i, cos_i), over_both),
                       hn::NegMulAdd(hn::Mul(alpha, over_both), change, peak));
    }

    /// D(h) / 2 = α² / (2π) · (|h|² / (α² h_z² + h_x² + h_y²))².
    static HWY_INLINE V<Floats> half_distribution(const HalfSum& sum, const View<Floats>& view) {
        const Floats d;
        const auto across = hn::MulAdd(sum.x, sum.x, hn::Mul(sum.y, sum.y));
        const auto up = hn::Mul(sum.z, sum.z);
        const auto sharpness = hn::Div(hn::Add(across, up), hn::MulAdd(view.alpha2, up, across));
        // Multiplied in this order a narrow lobe stays within a float's range.
        const auto peak = hn::Mul(view.alpha2, all(d, 1 / (2 * std::numbers::pi)));
        return hn::Mul(hn::Mul(peak, sharpness), sharpness);
    }

  private:
    /// √(α² + (1-α²) cos²θ).
    template <class D>
    static HWY_INLINE V<D> masking(D d, V<D> alpha2, V<D> cosine) {
        return hn::Sqrt(masking_squared(d, alpha2, cosine));
    }
    template <class D>
    static HWY_INLINE V<D> masking_squared(D d, V<D> alpha2, V<D> cosine) {
        return hn::MulAdd(hn::Mul(hn::Sub(all(d, 1), alpha2), cosine), cosine, alpha2);
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

/// cosθ (1 + 2 Λ) of Beckmann's distribution, as LobeAxes of ggx.cpp has it. across: α sinθ.
template <class D>
HWY_INLINE V<D> beckmann_masking(D d, V<D> across, V<D> cosine) {
    const auto a = hn::Div(cosine, hn::Max(across, all(d, 1e-30)));
    const auto above = hn::MulAdd(hn::MulAdd(all(d, 0.396), a, all(d, -1.259)), a, all(d, 1));
    const auto below = hn::MulAdd(all(d, 2.181), a, all(d, 3.535));
    const auto lambda = hn::Div(hn::Mul(hn::Add(across, across), above), below);
    return hn::Add(cosine, hn::IfThenElseZero(hn::Lt(a, all(d, kUnmasked)), lambda));
}

/// A half vector as a distribution of slopes sees it: tan²θ_h in units of α², and what it is divided by for that. norm:
/// α² (n + 1) / 2 of Ashikhmin & Shirley's exponent n.
template <class D>
struct RoundHalf {
    V<D> slope2, over_tangent2, norm;
};

/// 4 f·cos / D ÷ Fresnel's factor, of a distribution other than GGX. cos_half: ω_i·h; masking(): of ω_i.
template <class D, class Masking>
HWY_INLINE V<D> over_ndf_of_others(D d, Microfacets distribution, const RoundHalf<D>& half, V<D> cos_half, V<D> cos_i,
                                   V<D> cos_o, V<D> masking_o, const Masking& masking) {
    const auto over_ggx = hn::Add(all(d, 1), half.slope2);
    const auto factor = hn::Mul(cos_i, hn::Mul(over_ggx, over_ggx));
    if (distribution == Microfacets::ashikhmin_shirley) {
        // cosⁿθ_h ÷ the cos⁻⁴θ_h of GGX
        const auto tangent2 = hn::Div(half.slope2, half.over_tangent2);
        const auto power = hn::Add(half.over_tangent2, all(d, 1));
        const auto lobe = hn::Exp(d, hn::Neg(hn::Mul(power, hn::Log1p(d, tangent2))));
        const auto pump = hn::Mul(hn::Max(cos_half, all(d, 1e-6)), hn::Max(cos_i, cos_o));
        return hn::Div(hn::Mul(hn::Mul(factor, half.norm), lobe), pump);
    }
    const auto both = hn::MulAdd(cos_o, masking(), hn::Mul(cos_i, masking_o));
    return hn::Div(hn::Mul(hn::Add(factor, factor), hn::Exp(d, hn::Neg(half.slope2))), both);
}

/// Microfacets of any distribution and Fresnel factor, which are looked up at each call. f·cos is GGX's D times slowly
/// varying factors.
class MicrofacetLanes {
  public:
    using Ggx = GgxLanes<Fresnel::one>;
    template <class D>
    struct View {
        typename Ggx::View<D> ggx;
        V<D> alpha, masking;  // α, cosθ_o (1 + 2 Λ(θ_o))
    };

    explicit MicrofacetLanes(const GgxShape& shape) : shape_(shape), ggx_(shape) {}

    template <class D>
    HWY_INLINE View<D> view(D d, V<D> cos_o, V<D> alpha) const {
        const auto of_ggx = ggx_.view(d, cos_o, alpha);
        return {of_ggx, alpha, masking(d, alpha, cos_o)};
    }

    HWY_INLINE V<Floats> value(const HalfSum& sum, V<Floats> cos_i, const View<Floats>& view) const {
        const Floats d;
        const auto square = square_of(sum);
        const auto inverse = hn::Div(all(d, 1), hn::Sqrt(square));
        const HalfVector<Floats> half = {hn::Mul(sum.x, inverse), hn::Mul(sum.y, inverse), hn::Mul(sum.z, inverse),
                                         hn::Mul(all(d, 0.5), hn::Mul(square, inverse))};
        const auto quarter = hn::Mul(all(d, 0.5), Ggx::half_distribution(sum, view.ggx));
        return hn::Mul(quarter, over_ndf(d, half, cos_i, view));
    }

    HWY_INLINE V<Floats> density(const HalfSum& sum, V<Floats> cos_i, const View<Floats>& view) const {
        return ggx_.density(sum, cos_i, view.ggx);
    }

    template <class D>
    HWY_INLINE V<D> over_ndf(D d, const HalfVector<D>& half, V<D> cos_i, const View<D>& view) const {
        const auto fresnel = fresnel_of(d, shape_, half.cosine);
        if (shape_.distribution == Microfacets::ggx) {
            return hn::Mul(fresnel, ggx_.over_ndf(d, half, cos_i, view.ggx));
        }
        const auto across = hn::MulAdd(half.x, half.x, hn::Mul(half.y, half.y));
        const auto up = hn::Max(hn::Mul(half.z, half.z), all(d, 1e-12));
        const auto slope2 = hn::Min(hn::Div(across, hn::Mul(view.ggx.alpha2, up)), all(d, kLargestSlope2));
        const RoundHalf<D> round = {slope2, hn::Div(all(d, 1), view.ggx.alpha2),
                                    hn::NegMulAdd(all(d, 0.5), view.ggx.alpha2, all(d, 1))};
        const auto own = over_ndf_of_others(d, shape_.distribution, round, half.cosine, cos_i, view.ggx.cosine,
                                            view.masking, [&]() HWY_ATTR { return masking(d, view.alpha, cos_i); });
        return hn::Mul(fresnel, own);
    }

  private:
    template <class D>
    static HWY_INLINE V<D> masking(D d, V<D> alpha, V<D> cosine) {
        const auto sine = hn::Sqrt(hn::Max(hn::Zero(d), hn::NegMulAdd(cosine, cosine, all(d, 1))));
        return beckmann_masking(d, hn::Mul(alpha, sine), cosine);
    }

    GgxShape shape_;
    Ggx ggx_;
};

/// Microfacets with two widths, α_x and α_y, which all lanes share. over_ndf() takes vectors in the lobe's axes.
class StretchedLanes {
  public:
    template <class D>
    struct View {
        V<D> x, y, cosine;     // ω_o in the lobe's axes
        V<D> spread, masking;  // √(cos²θ_o + α_x² x² + α_y² y²), and cosθ_o (1 + 2 Λ(θ_o))
    };

    explicit StretchedLanes(const GgxShape& shape)
        : shape_(shape), turn_cosine_(std::cos(shape.azimuth)), turn_sine_(std::sin(shape.azimuth)) {}

    template <class D>
    HWY_INLINE View<D> view(D d, V<D> cos_o, V<D> /*parameter*/) const {
        const auto sine = hn::Sqrt(hn::Max(hn::Zero(d), hn::NegMulAdd(cos_o, cos_o, all(d, 1))));
        const auto x = hn::Mul(sine, all(d, turn_cosine_));
        const auto y = hn::Mul(sine, all(d, turn_sine_));
        return {x, y, cos_o, hn::Sqrt(hn::MulAdd(cos_o, cos_o, across(d, x, y))), masking(d, x, y, cos_o)};
    }

    HWY_INLINE V<Floats> value(const HalfSum& sum, V<Floats> cos_i, const View<Floats>& view) const {
        const Floats d;
        const HalfSum own = turned(sum);
        const auto square = hn::MulAdd(own.x, own.x, hn::MulAdd(own.y, own.y, hn::Mul(own.z, own.z)));
        const auto inverse = hn::Div(all(d, 1), hn::Sqrt(square));
        const HalfVector<Floats> half = {hn::Mul(own.x, inverse), hn::Mul(own.y, inverse), hn::Mul(own.z, inverse),
                                         hn::Mul(all(d, 0.5), hn::Mul(square, inverse))};
        const auto quarter = hn::Mul(all(d, 0.25), distribution(d, half.x, half.y, half.z));
        return hn::Mul(quarter, over_ndf(d, half, cos_i, view));
    }

    HWY_INLINE V<Floats> density(const HalfSum& sum, V<Floats> /*cos_i*/, const View<Floats>& view) const {
        const Floats d;
        const HalfSum own = turned(sum);
        const auto square = hn::MulAdd(own.x, own.x, hn::MulAdd(own.y, own.y, hn::Mul(own.z, own.z)));
        const auto inverse = hn::Div(all(d, 1), hn::Sqrt(square));
        const auto ndf = distribution(d, hn::Mul(own.x, inverse), hn::Mul(own.y, inverse), hn::Mul(own.z, inverse));
        return hn::Div(hn::Mul(all(d, 0.5), ndf), hn::Add(view.cosine, view.spread));
    }

    template <class D>
    HWY_INLINE V<D> over_ndf(D d, const HalfVector<D>& half, V<D> cos_i, const View<D>& view) const {
        const auto twice = hn::Add(half.cosine, half.cosine);
        const auto light_x = hn::MulSub(twice, half.x, view.x);
        const auto light_y = hn::MulSub(twice, half.y, view.y);
        const auto fresnel = fresnel_of(d, shape_, half.cosine);
        if (shape_.distribution == Microfacets::ggx) {
            const auto spread = hn::Sqrt(hn::MulAdd(cos_i, cos_i, across(d, light_x, light_y)));
            const auto both = hn::MulAdd(view.cosine, spread, hn::Mul(cos_i, view.spread));
            return hn::Mul(fresnel, hn::Div(hn::Add(cos_i, cos_i), both));
        }
        const auto tangents = hn::MulAdd(half.x, half.x, hn::Mul(half.y, half.y));
        const auto slopes = round(d, half.x, half.y);
        const auto up = hn::Max(hn::Mul(half.z, half.z), all(d, 1e-12));
        const double x2 = shape_.alpha * shape_.alpha;
        const double y2 = shape_.across * shape_.across;
        const auto least = hn::Max(tangents, all(d, 1e-30));
        const RoundHalf<D> own = {hn::Min(hn::Div(slopes, up), all(d, kLargestSlope2)),
                                  hn::Min(hn::Max(hn::Div(slopes, least), all(d, 1 / y2)), all(d, 1 / x2)),
                                  all(d, std::sqrt((1 - x2 / 2) * (1 - y2 / 2)))};
        const auto value =
            over_ndf_of_others(d, shape_.distribution, own, half.cosine, cos_i, view.cosine, view.masking,
                               [&]() HWY_ATTR { return masking(d, light_x, light_y, cos_i); });
        return hn::Mul(fresnel, value);
    }

    /// A slope times the width along its axis, for boundary_integral.h.
    template <class D>
    HWY_INLINE V<D> along_x(D d, V<D> slope) const {
        return hn::Mul(all(d, shape_.alpha), slope);
    }
    template <class D>
    HWY_INLINE V<D> along_y(D d, V<D> slope) const {
        return hn::Mul(all(d, shape_.across), slope);
    }

  private:
    HWY_INLINE HalfSum turned(const HalfSum& v) const {
        const Floats d;
        const auto c = all(d, turn_cosine_);
        const auto s = all(d, turn_sine_);
        return {hn::MulSub(c, v.x, hn::Mul(s, v.y)), hn::MulAdd(s, v.x, hn::Mul(c, v.y)), v.z};
    }
    /// α_x² x² + α_y² y².
    template <class D>
    HWY_INLINE V<D> across(D d, V<D> x, V<D> y) const {
        const auto own_x = along_x(d, x);
        const auto own_y = along_y(d, y);
        return hn::MulAdd(own_x, own_x, hn::Mul(own_y, own_y));
    }
    /// x² / α_x² + y² / α_y².
    template <class D>
    HWY_INLINE V<D> round(D d, V<D> x, V<D> y) const {
        const auto own_x = hn::Mul(x, all(d, 1 / shape_.alpha));
        const auto own_y = hn::Mul(y, all(d, 1 / shape_.across));
        return hn::MulAdd(own_x, own_x, hn::Mul(own_y, own_y));
    }
    HWY_INLINE V<Floats> distribution(Floats d, V<Floats> x, V<Floats> y, V<Floats> z) const {
        const auto square = hn::MulAdd(z, z, round(d, x, y));
        // Divided in this order a narrow lobe stays within a float's range.
        return hn::Div(hn::Div(all(d, 1 / (std::numbers::pi * shape_.alpha * shape_.across)), square), square);
    }
    template <class D>
    HWY_INLINE V<D> masking(D d, V<D> x, V<D> y, V<D> cosine) const {
        return beckmann_masking(d, hn::Sqrt(across(d, x, y)), cosine);
    }

    GgxShape shape_;
    double turn_cosine_, turn_sine_;
};

template <class Function>
void with_lanes_of(const GgxShape& shape, const Function& function) {
    if (shape.across != 0) {
        return function(StretchedLanes(shape));
    }
    if (shape.distribution != Microfacets::ggx) {
        return function(MicrofacetLanes(shape));
    }
    switch (shape.fresnel) {
        case Fresnel::one:
            return function(GgxLanes<Fresnel::one>(shape));
        case Fresnel::schlick:
            return function(GgxLanes<Fresnel::schlick>(shape));
        case Fresnel::dip:
            return function(GgxLanes<Fresnel::dip>(shape));
        case Fresnel::dielectric:
            return function(GgxLanes<Fresnel::dielectric>(shape));
        case Fresnel::wide_dip:
        case Fresnel::narrow_dip:
        case Fresnel::broad_dip:
        case Fresnel::linear:
            return function(MicrofacetLanes(shape));
    }
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
