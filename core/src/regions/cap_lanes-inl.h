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
    V<D> solid_angle;  ///< of the kept region
    V<D> height, horizon_sine;  ///< z_0 and √(1 - z_0²), which a narrow boost needs beside it
};

/// As CapArrays, and a square that would lose digits if it were taken of rounded members.
template <class D>
struct SphericalCapLanes {
    V<D> x, y, z;
    V<D> cosine, sine;
    V<D> tilt_squared;      ///< sin²θ
    V<D> crossing_squared;  ///< sin²σ - L_z², positive where the circle crosses the plane z = 0
};

/// As Boost (boost.h).
template <class D>
struct BoostLanes {
    V<D> sin_tilt, cos_tilt;
    V<D> speed, one_minus_speed, gamma;
    V<D> horizon_x, horizon_z;
    V<D> horizon_height, horizon_sine;
};

/// Those of as many lobes as there are lanes for float.
struct BoostPair {
    BoostLanes<Doubles> low, high;
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
    const auto lack = hn::Div(hn::Mul(circle.sine, circle.sine), hn::Add(one, cosine));
    const auto turn =
        arctangent(d, hn::Mul(hn::Mul(chord, z), lack), hn::MulAdd(chord, chord, hn::Mul(hn::Mul(cosine, z), z)));
    const auto half_area = hn::MulAdd(cap.edge, lack, turn);
    const auto area = hn::Add(half_area, half_area);
    const auto kept = hn::IfThenElse(wide, hn::Sub(all(d, 2 * std::numbers::pi), area), area);
    cap.solid_angle = hn::Max(zero, kept);
    return cap;
}

/// The circles of a light and of the horizon, and the triangle of their poles and a point where they cross. Each pair
/// (`chord`, cosine) is the product of two sides' sines times the (sine, cosine) of the angle between those sides.
template <class D>
struct ContactLanes {
    SphericalCapLanes<D> light;
    V<D> height, sine;   // the horizon, height ≤ 0
    V<D> chord_squared;  // not positive where the circles do not cross
    V<D> corner;         // cosθ - cosσ z_0: at the crossing
    V<D> arc;            // cosσ - z_0 cosθ: at the horizon's pole
    V<D> edge;           // z_0 - cosσ cosθ: at the light's pole
};

/// `arc` and `edge` from `corner`, as the form whose terms are smaller gives them. The first keeps every digit of small
/// lights and of the plane z_0 = 0; the second that of nearly equal or nearly opposite circles, where it is
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
    const auto lack = hn::Div(hn::Mul(contact.light.sine, contact.light.sine), hn::Add(one, cosine));
    const auto short_of_pole = hn::Div(hn::Mul(contact.sine, contact.sine), hn::Add(one, depth));

    const auto deep = hn::Gt(depth, all(d, 0.5));
    const auto y = hn::Mul(chord, hn::IfThenElse(deep, one, hn::Mul(hn::Add(depth, tilt), lack)));
    const auto x = hn::IfThenElse(deep, hn::Add(hn::Add(one, tilt), hn::Add(cosine, depth)),
                                  hn::MulAdd(contact.edge, corner, contact.chord_squared));
    const auto angle = arctangent(d, y, x);
    const auto rest =
        hn::IfThenElse(deep, hn::MulSub(arc, short_of_pole, hn::Add(angle, angle)), hn::NegMulAdd(arc, depth, angle));
    const auto half_lens = hn::MulAdd(hn::Sub(pi, edge), lack, rest);
    const auto area = hn::MulSub(two_pi, lack, hn::Add(half_lens, half_lens));
    return hn::IfThenElse(wide, hn::MulSub(two_pi, hn::Add(one, depth), area), area);
}

/// What is kept where circles do not cross: they are nested, or apart, or together they cover the sphere. `corner`
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

/// A light through a boost against the image of the plane z = 0. The boost is a Lorentz transform of the circles'
/// 4-vectors (cosine; axis): their product is invariant, so where a light crosses the horizon is known from before the
/// boost, with all digits.
template <class D>
HWY_INLINE ContactLanes<D> boosted_contact(D d, const SphericalCapLanes<D>& circle, const BoostLanes<D>& boost) {
    const auto zero = hn::Zero(d);
    const auto one = all(d, 1);
    // The differences from 1 that a strong boost would cancel: |L| - L·axis and |L| - c, with |L| = 1.
    const auto lack = one_minus(d, circle.cosine, circle.sine);
    const auto off_x = hn::Add(circle.x, boost.sin_tilt);
    const auto off_z = hn::Sub(circle.z, boost.cos_tilt);
    const auto off = hn::MulAdd(off_x, off_x, hn::MulAdd(circle.y, circle.y, hn::Mul(off_z, off_z)));
    const auto gap = hn::Mul(all(d, 0.5), off);
    const auto across = hn::MulAdd(boost.cos_tilt, circle.x, hn::Mul(boost.sin_tilt, circle.z));
    // γ (L_∥ - b c) and γ (c - b L_∥) with L_∥ = 1 - gap, c = 1 - lack.
    const auto along = hn::Mul(boost.gamma, hn::MulAdd(boost.speed, lack, hn::Sub(boost.one_minus_speed, gap)));
    const auto cosine = hn::Mul(boost.gamma, hn::MulAdd(boost.speed, gap, hn::Sub(boost.one_minus_speed, lack)));
    const auto x = hn::MulSub(boost.horizon_z, across, hn::Mul(boost.horizon_x, along));
    const auto z = hn::MulAdd(boost.horizon_x, across, hn::Mul(boost.horizon_z, along));
    const auto square = hn::MulAdd(x, x, hn::MulAdd(circle.y, circle.y, hn::Mul(z, z)));
    const auto scale = hn::Div(one, hn::Sqrt(square));
    const auto ux = hn::Mul(x, scale);
    const auto uy = hn::Mul(circle.y, scale);
    const SphericalCapLanes<D> image{ux,
                                     uy,
                                     hn::Mul(z, scale),
                                     hn::Mul(cosine, scale),
                                     hn::Mul(circle.sine, scale),
                                     hn::MulAdd(ux, ux, hn::Mul(uy, uy)),
                                     zero};
    const auto shrink = hn::Mul(scale, boost.horizon_sine);
    ContactLanes<D> contact{image, boost.horizon_height, boost.horizon_sine, zero, zero, zero, zero};
    contact.chord_squared = hn::Mul(circle.crossing_squared, hn::Mul(shrink, shrink));
    contact.corner = hn::Mul(circle.z, shrink);
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
HWY_INLINE SphericalCapLanes<Lanes<T>> narrowed_circle(const SphericalCapLanes<Doubles>& low,
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
    return {narrowed_circle<T>(low.light, high.light), narrowed<T>(low.height, high.height),
            narrowed<T>(low.sine, high.sine),          narrowed<T>(low.chord_squared, high.chord_squared),
            narrowed<T>(low.corner, high.corner),      narrowed<T>(low.arc, high.arc),
            narrowed<T>(low.edge, high.edge)};
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
