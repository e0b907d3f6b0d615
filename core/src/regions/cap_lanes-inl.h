// SPDX-License-Identifier: MIT
//
// Caps and what a horizon keeps of them, one light in each lane (docs/theory.md, 3.3 and 3.5).
// Included once per instruction set.
#if defined(SHLIGHT_KERNELS_CAP_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_CAP_LANES_INL_H_
#undef SHLIGHT_KERNELS_CAP_LANES_INL_H_
#else
#define SHLIGHT_KERNELS_CAP_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "regions/boost_lanes-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// A cap {u : u·L ≥ cosσ} and what the horizon u_z ≥ z_0 keeps of it, as the recurrences want them. The horizon is the
/// plane z = 0 or its image through a boost, which lies below it.
template <class D>
struct ClippedCap {
    V<D> cos_tilt, sin_tilt;        ///< θ, the angle between the cap's axis L and z
    V<D> cos_azimuth, sin_azimuth;  ///< the axis' azimuth about z
    V<D> cos_half, sin_half;        ///< half angle σ, 0 < σ ≤ π
    V<D> arc;                       ///< φ_a: the cap covers the horizon within φ_a of its axis' azimuth; 0 … π
    V<D> cos_arc, sin_arc;
    V<D> edge;         ///< ψ_0: the cap's edge is above the horizon within ψ_0 of its highest point; 0 … π
    V<D> edge_height;  ///< z_0 - cosσ cosθ = sinσ sinθ cos(edge)
    V<D> solid_angle;  ///< the kept region's
    V<D> height, horizon_sine;  ///< z_0 and √(1 - z_0²), which a narrow boost needs beside it
};

/// A cap in each lane, and squares that would lose digits if they were taken of rounded members.
template <class D>
struct SphericalCapLanes {
    V<D> x, y, z;
    V<D> cosine, sine;
    V<D> tilt_squared;      ///< sin²θ
    V<D> crossing_squared;  ///< sin²σ - L_z², positive where the circle crosses the plane z = 0
};

/// 1 - x for x = cos α, without cancellation.
template <class D>
HWY_INLINE V<D> one_minus(D d, V<D> cosine, V<D> sine) {
    const auto one = all(d, 1);
    const auto acute = hn::Div(hn::Mul(sine, sine), hn::Add(one, hn::Abs(cosine)));
    return hn::IfThenElse(hn::Gt(cosine, hn::Zero(d)), acute, hn::Sub(one, cosine));
}

/// The direction of the cap's axis.
template <class D>
HWY_INLINE void set_axis(D d, const SphericalCapLanes<D>& circle, ClippedCap<D>& cap) {
    cap.cos_tilt = circle.z;
    cap.sin_tilt = hn::Sqrt(circle.tilt_squared);
    cap.cos_half = circle.cosine;
    cap.sin_half = circle.sine;
    const auto tilted = hn::Gt(cap.sin_tilt, hn::Zero(d));
    const auto across = hn::Div(all(d, 1), cap.sin_tilt);
    cap.cos_azimuth = hn::IfThenElse(tilted, hn::Mul(circle.x, across), all(d, 1));
    cap.sin_azimuth = hn::IfThenElseZero(tilted, hn::Mul(circle.y, across));
}

/// cos_arc, sin_arc and arc from the point (arc_cosine, chord), of any length.
template <class D>
HWY_INLINE void set_arc(D d, V<D> chord, V<D> arc_cosine, ClippedCap<D>& cap) {
    const auto square = hn::MulAdd(chord, chord, hn::Mul(arc_cosine, arc_cosine));
    const auto some = hn::Gt(square, hn::Zero(d));
    const auto across = hn::Div(all(d, 1), hn::Sqrt(square));
    cap.arc = arctangent(d, chord, arc_cosine);
    cap.cos_arc = hn::IfThenElse(some, hn::Mul(arc_cosine, across), all(d, 1));
    cap.sin_arc = hn::IfThenElseZero(some, hn::Mul(chord, across));
}

/// A cap that crosses the plane z = 0, in the precision of D: given crossing_squared with all digits, nothing cancels
/// but the last sum of solid angles below the horizon.
template <class D>
HWY_INLINE ClippedCap<D> cap_across_plane(D d, const SphericalCapLanes<D>& circle) {
    ClippedCap<D> cap;
    set_axis(d, circle, cap);
    const auto zero = hn::Zero(d);
    const auto one = all(d, 1);
    const auto chord = root(d, circle.crossing_squared);
    set_arc(d, chord, circle.cosine, cap);
    cap.edge_height = hn::Neg(hn::Mul(circle.cosine, circle.z));
    cap.edge = arctangent(d, chord, cap.edge_height);
    cap.height = zero;
    cap.horizon_sine = one;
    // A cap above a hemisphere is the complement of the opposite one.
    const auto wide = hn::Lt(circle.cosine, zero);
    const auto cosine = hn::Abs(circle.cosine);
    const auto z = hn::IfThenElse(wide, hn::Neg(circle.z), circle.z);
    const auto one_minus_cos = hn::Div(hn::Mul(circle.sine, circle.sine), hn::Add(one, cosine));
    const auto turn = arctangent(d, hn::Mul(hn::Mul(chord, z), one_minus_cos),
                                 hn::MulAdd(chord, chord, hn::Mul(hn::Mul(cosine, z), z)));
    const auto half_area = hn::MulAdd(cap.edge, one_minus_cos, turn);
    const auto area = hn::Add(half_area, half_area);
    const auto kept = hn::IfThenElse(wide, hn::Sub(all(d, 2 * std::numbers::pi), area), area);
    cap.solid_angle = hn::Max(zero, kept);
    return cap;
}

/// The caps of a light and of the horizon, and the triangle of their poles and a point where they cross. Each pair
/// (`chord`, cosine) is the product of two sides' sines times the (sine, cosine) of the angle between those sides.
template <class D>
struct ContactLanes {
    SphericalCapLanes<D> light;
    V<D> height, sine;   // the horizon, height ≤ 0
    V<D> chord_squared;  // not positive where the caps do not cross
    V<D> corner;         // cosθ - cosσ z_0: at the crossing
    V<D> arc;            // cosσ - z_0 cosθ: at the horizon's pole
    V<D> edge;           // z_0 - cosσ cosθ: at the light's pole
};

/// `arc` and `edge` from `corner`, as the form whose terms are smaller gives them. The first keeps every digit of small
/// lights and of the plane z_0 = 0; the second that of nearly equal or nearly opposite caps, where it is
/// arc ± edge = (cosσ ± z_0)(1 ∓ cosθ) that must be right.
template <class D>
HWY_INLINE void complete(D d, ContactLanes<D>& contact) {
    const auto c = contact.light.cosine;
    const auto z = contact.height;
    const auto own = hn::Mul(c, hn::Mul(contact.sine, contact.sine));
    const auto other = hn::Mul(z, hn::Mul(contact.light.sine, contact.light.sine));
    // 1 ∓ cosθ, one of which would cancel.
    const auto more = hn::Add(all(d, 1), hn::Abs(contact.light.z));
    const auto less = hn::Div(contact.light.tilt_squared, more);
    const auto up = hn::Gt(contact.light.z, hn::Zero(d));
    const auto sum = hn::Mul(hn::Add(c, z), hn::IfThenElse(up, less, more));
    const auto difference = hn::Mul(hn::Sub(c, z), hn::IfThenElse(up, more, less));
    const auto size =
        hn::MulAdd(hn::Add(hn::Abs(c), hn::Abs(z)), hn::Abs(contact.corner), hn::Add(hn::Abs(own), hn::Abs(other)));
    const auto direct = hn::Le(size, hn::Add(hn::Abs(sum), hn::Abs(difference)));
    const auto half = all(d, 0.5);
    contact.arc =
        hn::IfThenElse(direct, hn::NegMulAdd(z, contact.corner, own), hn::Mul(half, hn::Add(sum, difference)));
    contact.edge =
        hn::IfThenElse(direct, hn::NegMulAdd(c, contact.corner, other), hn::Mul(half, hn::Sub(sum, difference)));
}

/// Area of what a horizon with z_0 ≤ 0 keeps of a light that crosses it: the light's less that of the lens below the
/// horizon. Gauss–Bonnet for caps up to hemispheres, lights above them are turned inside out; with h = -z_0, with E the
/// excess of the triangle and β the exterior angle at the crossing, the lens of ψ_0 and φ_a seen from below has
///   Ω/2 = ψ_0 (1 - cosσ) + φ_a (1 - h) - E = ψ_0 (1 - cosσ) + (β - ψ_0) - φ_a h.
/// The first form is for high h, where E is small; the second for low ones, where β - ψ_0 is one arctangent of numbers
/// as small as the light.
template <class D>
HWY_INLINE V<D> kept_area(D d, const ContactLanes<D>& contact, V<D> chord, V<D> arc, V<D> edge) {
    const auto one = all(d, 1);
    const auto pi = all(d, std::numbers::pi);
    const auto two_pi = all(d, 2 * std::numbers::pi);
    const auto wide = hn::Lt(contact.light.cosine, hn::Zero(d));
    const auto cosine = hn::Abs(contact.light.cosine);
    const auto depth = hn::Abs(contact.height);
    const auto tilt = hn::IfThenElse(wide, contact.light.z, hn::Neg(contact.light.z));
    const auto corner = hn::IfThenElse(wide, contact.corner, hn::Neg(contact.corner));
    arc = hn::IfThenElse(wide, hn::Sub(pi, arc), arc);
    const auto one_minus_cos = hn::Div(hn::Mul(contact.light.sine, contact.light.sine), hn::Add(one, cosine));
    const auto short_of_pole = hn::Div(hn::Mul(contact.sine, contact.sine), hn::Add(one, depth));

    const auto deep = hn::Gt(depth, all(d, 0.5));
    const auto y = hn::Mul(chord, hn::IfThenElse(deep, one, hn::Mul(hn::Add(depth, tilt), one_minus_cos)));
    const auto x = hn::IfThenElse(deep, hn::Add(hn::Add(one, tilt), hn::Add(cosine, depth)),
                                  hn::MulAdd(contact.edge, corner, contact.chord_squared));
    const auto angle = arctangent(d, y, x);
    const auto rest =
        hn::IfThenElse(deep, hn::MulSub(arc, short_of_pole, hn::Add(angle, angle)), hn::NegMulAdd(arc, depth, angle));
    const auto half_lens = hn::MulAdd(hn::Sub(pi, edge), one_minus_cos, rest);
    const auto area = hn::MulSub(two_pi, one_minus_cos, hn::Add(half_lens, half_lens));
    return hn::IfThenElse(wide, hn::MulSub(two_pi, hn::Add(one, depth), area), area);
}

/// What is kept where caps do not cross: they are nested, or apart, or together they cover the sphere. `corner`
/// decides whether they are nested; which of the two others holds is a question of size, continuous where they touch.
template <class D>
HWY_INLINE void keep_uncrossed(D d, const ContactLanes<D>& contact, ClippedCap<D>& cap) {
    const auto zero = hn::Zero(d);
    const auto pi = all(d, std::numbers::pi);
    const auto two_pi = all(d, 2 * std::numbers::pi);
    const auto cosine = contact.light.cosine;
    const auto nested = hn::Ge(contact.corner, zero);
    const auto inner = hn::Ge(cosine, contact.height);
    const auto light = hn::Mul(two_pi, one_minus(d, cosine, contact.light.sine));
    const auto above = hn::Mul(two_pi, one_minus(d, contact.height, contact.sine));
    const auto rest = hn::Max(zero, hn::Neg(hn::Mul(two_pi, hn::Add(cosine, contact.height))));
    const auto overlap = hn::AndNot(nested, hn::Gt(rest, zero));
    cap.arc = hn::IfThenElseZero(hn::Or(overlap, hn::AndNot(inner, nested)), pi);
    cap.edge = hn::IfThenElseZero(hn::Or(overlap, hn::And(inner, nested)), pi);
    cap.solid_angle = hn::IfThenElse(nested, hn::IfThenElse(inner, light, above), rest);
    cap.cos_arc = all(d, 1);
    cap.sin_arc = zero;
}

/// Cap and horizon from their contact: lanes that cross, lanes that do not, in any mixture.
template <class D>
HWY_INLINE ClippedCap<D> cap_in_contact(D d, const ContactLanes<D>& contact) {
    ClippedCap<D> cap;
    set_axis(d, contact.light, cap);
    cap.height = contact.height;
    cap.horizon_sine = contact.sine;
    cap.edge_height = contact.edge;
    const auto crossing = hn::Gt(contact.chord_squared, hn::Zero(d));
    if (hn::AllFalse(d, crossing)) {
        keep_uncrossed(d, contact, cap);
        return cap;
    }
    const auto chord = root(d, contact.chord_squared);
    set_arc(d, chord, contact.arc, cap);
    cap.edge = arctangent(d, chord, contact.edge);
    cap.solid_angle = hn::Max(hn::Zero(d), kept_area(d, contact, chord, cap.arc, cap.edge));
    if (!hn::AllTrue(d, crossing)) {
        ClippedCap<D> other;
        keep_uncrossed(d, contact, other);
        cap.arc = hn::IfThenElse(crossing, cap.arc, other.arc);
        cap.cos_arc = hn::IfThenElse(crossing, cap.cos_arc, other.cos_arc);
        cap.sin_arc = hn::IfThenElse(crossing, cap.sin_arc, other.sin_arc);
        cap.edge = hn::IfThenElse(crossing, cap.edge, other.edge);
        cap.solid_angle = hn::IfThenElse(crossing, cap.solid_angle, other.solid_angle);
    }
    return cap;
}

/// A cap that does not cross the plane z = 0, or of which all is kept, as if the horizon were the point below.
template <class D>
HWY_INLINE ClippedCap<D> cap_off_plane(D d, const SphericalCapLanes<D>& circle, bool whole) {
    ClippedCap<D> cap;
    set_axis(d, circle, cap);
    const auto zero = hn::Zero(d);
    cap.height = cap.edge_height = zero;
    cap.horizon_sine = all(d, 1);
    keep_uncrossed(
        d, ContactLanes<D>{circle, all(d, whole ? -1 : 0), cap.horizon_sine, zero, whole ? zero : circle.z, zero, zero},
        cap);
    return cap;
}

/// A cap against the plane z = 0, all lanes alike, or without a horizon.
template <bool kCrossing, class D>
HWY_INLINE ClippedCap<D> cap_at_plane(D d, const SphericalCapLanes<D>& circle, bool whole = false) {
    return kCrossing ? cap_across_plane(d, circle) : cap_off_plane(d, circle, whole);
}

/// A light through a boost against the image of the plane z = 0. Boosts keep the product of 4-vectors, so where a
/// light crosses the horizon is known from before the boost, with all digits.
HWY_INLINE ContactLanes<Doubles> boosted_contact(const SphericalCapLanes<Doubles>& cap, const BoostLanes& boost) {
    const Doubles d;
    const auto zero = hn::Zero(d);
    const auto [axis, cosine, ratio] = boost.image({cap.x, cap.y, cap.z}, one_minus(d, cap.cosine, cap.sine));
    const auto shrink = hn::Mul(ratio, boost.horizon_sine);
    ContactLanes<Doubles> contact{{axis.x, axis.y, axis.z, cosine, hn::Mul(cap.sine, ratio),
                                   hn::MulAdd(axis.x, axis.x, hn::Mul(axis.y, axis.y)), zero},
                                  boost.horizon_height,
                                  boost.horizon_sine,
                                  hn::Mul(cap.crossing_squared, hn::Mul(shrink, shrink)),
                                  hn::Mul(cap.z, shrink),
                                  zero,
                                  zero};
    complete(d, contact);
    return contact;
}

/// Two vectors of doubles as one of floats, rounded; the first of them as it is where T is double.
template <class T>
HWY_INLINE V<Lanes<T>> narrowed(V<Doubles> low, V<Doubles> high) {
    if constexpr (sizeof(T) == 4) {
        const Lanes<T> d;
        const hn::Half<Lanes<T>> half;
        return hn::Combine(d, hn::DemoteTo(half, high), hn::DemoteTo(half, low));
    } else {
        return low;
    }
}

template <class T>
HWY_INLINE SphericalCapLanes<Lanes<T>> narrowed_cap(const SphericalCapLanes<Doubles>& low,
                                                    const SphericalCapLanes<Doubles>& high) {
    return {narrowed<T>(low.x, high.x),
            narrowed<T>(low.y, high.y),
            narrowed<T>(low.z, high.z),
            narrowed<T>(low.cosine, high.cosine),
            narrowed<T>(low.sine, high.sine),
            narrowed<T>(low.tilt_squared, high.tilt_squared),
            narrowed<T>(low.crossing_squared, high.crossing_squared)};
}

/// What is sensitive was worked out: angles and areas lose no more in T than the bands do.
template <class T>
HWY_INLINE ContactLanes<Lanes<T>> narrowed_contact(const ContactLanes<Doubles>& low,
                                                   const ContactLanes<Doubles>& high) {
    return {narrowed_cap<T>(low.light, high.light), narrowed<T>(low.height, high.height),
            narrowed<T>(low.sine, high.sine),       narrowed<T>(low.chord_squared, high.chord_squared),
            narrowed<T>(low.corner, high.corner),   narrowed<T>(low.arc, high.arc),
            narrowed<T>(low.edge, high.edge)};
}

/// |c|² - r² without the cancellation of |c| ≈ r, in doubled precision (Ogita, Rump & Oishi 2005, Dot2).
HWY_INLINE V<Doubles> tangent_squared(V<Doubles> x, V<Doubles> y, V<Doubles> z, V<Doubles> r) {
    const auto first = hn::Mul(r, r);
    auto high = hn::Neg(first);
    auto low = hn::Neg(product_error(r, r, first));
    const auto add = [&](V<Doubles> v) HWY_ATTR {
        const auto square = hn::Mul(v, v);
        const auto sum = hn::Add(high, square);
        const auto rest = hn::Sub(sum, high);
        const auto lost = hn::Add(hn::Sub(high, hn::Sub(sum, rest)), hn::Sub(square, rest));
        low = hn::Add(low, hn::Add(lost, product_error(v, v, square)));
        high = sum;
    };
    add(x);
    add(y);
    add(z);
    return hn::Add(high, low);
}

/// The part of a sphere's cap that needs doubles. T: the type that the sphere was given in. Products of floats are
/// exact in doubles, and in range; numbers of doubles are scaled.
template <class T>
struct SphereRatios {
    V<Doubles> inverse;  // 1 / |c|
    V<Doubles> z, cosine_squared, tilt_squared, crossing_squared;

    HWY_INLINE SphereRatios(V<Doubles>& x, V<Doubles>& y, V<Doubles>& own_z, V<Doubles>& r) {
        const Doubles d;
        constexpr bool kExact = sizeof(T) == 4;
        if constexpr (!kExact) {
            const auto scale = power_of_two_scale(hn::Max(hn::Abs(x), hn::Max(hn::Abs(y), hn::Abs(own_z))));
            x = hn::Mul(x, scale);
            y = hn::Mul(y, scale);
            own_z = hn::Mul(own_z, scale);
            r = hn::Mul(r, scale);
        }
        const auto across = hn::MulAdd(x, x, hn::Mul(y, y));
        const auto square = hn::MulAdd(own_z, own_z, across);
        const auto inverse_square = hn::Div(all(d, 1), square);
        const auto tangent = kExact ? hn::NegMulAdd(r, r, square) : tangent_squared(x, y, own_z, r);
        inverse = hn::Sqrt(inverse_square);
        z = hn::Mul(own_z, inverse);
        cosine_squared = hn::Mul(tangent, inverse_square);
        tilt_squared = hn::Mul(across, inverse_square);
        crossing_squared = hn::Mul(hn::Mul(hn::Sub(r, own_z), hn::Add(r, own_z)), inverse_square);
    }
};

/// cap_of_sphere (boost.h), with where it crosses the plane z = 0 from centre and radius.
template <class T>
HWY_INLINE SphericalCapLanes<Doubles> cap_of_sphere_in_lanes(V<Doubles> x, V<Doubles> y, V<Doubles> z, V<Doubles> r) {
    const Doubles d;
    const SphereRatios<T> ratios(x, y, z, r);
    return {hn::Mul(x, ratios.inverse),
            hn::Mul(y, ratios.inverse),
            ratios.z,
            root(d, ratios.cosine_squared),
            hn::Min(all(d, 1), hn::Mul(r, ratios.inverse)),
            ratios.tilt_squared,
            ratios.crossing_squared};
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
