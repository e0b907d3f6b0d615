// SPDX-License-Identifier: MIT
//
// The integrals of the basis over caps, band by band, one light in each lane (docs/theory.md, 2 and 3;
// tools/methods/clipped_cap.h is the same in scalars).
// Included once per instruction set.
#if defined(SHLIGHT_KERNELS_CAP_BANDS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_CAP_BANDS_INL_H_
#undef SHLIGHT_KERNELS_CAP_BANDS_INL_H_
#else
#define SHLIGHT_KERNELS_CAP_BANDS_INL_H_
#endif

#include <hwy/highway.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "regions/cap_constants.h"
#include "regions/cap_lanes-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// Below this sine of a cap's tilt or of a horizon, unscaled recurrences would leave the range of T.
template <class T>
inline double least_unscaled_sine(std::size_t order) {
    const double exponent = sizeof(T) == 4 ? -80 : -600;
    return order > 1 ? std::exp2(exponent / static_cast<double>(order - 1)) : 0;
}

/// One vector for each degree m.
template <class T>
class DegreeRow {
    using D = Lanes<T>;

  public:
    HWY_INLINE V<D> operator[](std::size_t m) const { return hn::Load(D(), values_.data() + m * kLaneCount<D>); }
    HWY_INLINE void put(std::size_t m, V<D> value) { hn::Store(value, D(), values_.data() + m * kLaneCount<D>); }

  private:
    // One more than there are degrees, or rows would lie a multiple of 4 KiB apart and compete for the same cache
    // lines.
    alignas(64) std::array<T, static_cast<std::size_t>(kMaxOrder + 1) * kLaneCount<D>> values_;
};

/// row[m] = base^m for m < count; kScaled: what would be denormal is zero.
template <class T, bool kScaled>
HWY_INLINE void powers_in_lanes(V<Lanes<T>> base, std::size_t count, DegreeRow<T>& row) {
    const Lanes<T> d;
    const auto least = hn::Set(d, std::numeric_limits<T>::min() / std::numeric_limits<T>::epsilon());
    auto power = all(d, 1);
    for (std::size_t m = 0; m < count; ++m) {
        row.put(m, power);
        power = hn::Mul(power, base);
        power = kScaled ? hn::IfThenElseZero(hn::Gt(power, least), power) : power;
    }
}

/// sin²σ P_l'(cosσ) for l = 1, 2, 3 … in turn: 2π/(l(l+1)) times it is ∫ P_l(ω·L) dω over the whole cap, without the
/// cancellation of 2π (P_{l-1} - P_{l+1}) / (2l+1).
/// For small caps P_l falls from 1 by l(l+1)/2 · (1 - cosσ): the recurrence runs on the differences P_l - P_{l-1} and
/// on 1 - cosσ = sin²σ / (1 + cosσ), because a rounded cosσ would be amplified by l². Large caps are the mirror image,
/// P_l'(-x) = (-1)^{l+1} P_l'(x).
template <class T>
class ZonalLanes {
    using D = Lanes<T>;

  public:
    ZonalLanes(V<D> cosine, V<D> sine, const CapConstants<T>& constants) : bands_(constants.bands.data()) {
        const D d;
        sine_squared_ = hn::Mul(sine, sine);
        one_minus_cos_ = hn::Div(sine_squared_, hn::Add(all(d, 1), hn::Abs(cosine)));
        even_ = hn::IfThenElse(hn::Lt(cosine, hn::Zero(d)), hn::Neg(sine_squared_), sine_squared_);
        p_ = all(d, 1);
        rise_ = derivative_ = derivative_before_ = hn::Zero(d);
    }

    HWY_INLINE V<D> next(std::size_t l) {
        const D d;
        const CapBand<T>& band = bands_[l];
        const auto derivative = hn::MulAdd(all(d, static_cast<double>(2 * l - 1)), p_, derivative_before_);
        derivative_before_ = derivative_;  // P'_l = P'_{l-2} + (2l-1) P_{l-1}
        derivative_ = derivative;
        rise_ =
            hn::MulSub(hn::Set(d, band.rise_a), rise_, hn::Mul(hn::Mul(hn::Set(d, band.rise_b), one_minus_cos_), p_));
        p_ = hn::Add(p_, rise_);
        return hn::Mul(l % 2 == 0 ? even_ : sine_squared_, derivative);
    }

  private:
    const CapBand<T>* bands_;
    V<D> sine_squared_, even_, one_minus_cos_;
    V<D> p_, rise_;                        // P_l, P_l - P_{l-1} at |cosσ|
    V<D> derivative_, derivative_before_;  // P'_l, P'_{l-1}
};

/// Integrals along the horizon's covered arc |φ| ≤ φ_a = a:
///   weight[m] = ∫ cos mφ dφ, twice that for m > 0;  moment[m] = ∫ sin mφ sin φ dφ = 2 D_m / (m²-1),
///   D_m = sin ma cos a - m cos ma sin a.
/// For short arcs the terms of D_m agree to a³, but D_{m+1} = cos a D_m + (m+1) sin²a sin ma sums terms of one sign.
template <class T>
struct HorizonIntegrals {
    DegreeRow<T> weight, moment;

    HWY_INLINE HorizonIntegrals(const ClippedCap<Lanes<T>>& cap, std::size_t order, const CapConstants<T>& constants) {
        const Lanes<T> d;
        const auto cosine = cap.cos_arc;
        const auto sine = cap.sin_arc;
        const auto square = hn::Mul(sine, sine);
        const CapDegree<T>* degrees = constants.degrees.data();
        weight.put(0, hn::Add(cap.arc, cap.arc));
        moment.put(0, hn::Zero(d));
        auto re = cosine;
        auto im = sine;
        auto difference = hn::Zero(d);
        for (std::size_t m = 1; m < order; ++m) {
            weight.put(m, hn::Mul(hn::Set(d, degrees[m].weight), im));
            moment.put(m, hn::Mul(hn::Set(d, degrees[m].moment), difference));
            const auto added = hn::Mul(hn::Mul(hn::Set(d, degrees[m].next), square), im);
            difference = hn::MulAdd(cosine, difference, added);
            const auto next = hn::MulSub(re, cosine, hn::Mul(im, sine));
            im = hn::MulAdd(re, sine, hn::Mul(im, cosine));
            re = next;
        }
        moment.put(1, first_moment(cap));
    }

  private:
    /// a - sin a cos a: for short arcs by its power series, (2a - sin 2a) / 2.
    static HWY_INLINE V<Lanes<T>> first_moment(const ClippedCap<Lanes<T>>& cap) {
        const Lanes<T> d;
        const auto square = hn::Mul(cap.arc, cap.arc);
        constexpr int kTerms = sizeof(T) == 4 ? 6 : 11;
        // The term of a^(2j+1) is -(-1)^j 2^(2j) / (2j+1)!.
        auto sum = hn::Zero(d);
        for (int j = kTerms; j >= 1; --j) {
            double coefficient = -1;
            for (int k = 1; k <= j; ++k) {
                coefficient *= -4.0 / (2 * k * (2 * k + 1));
            }
            sum = hn::MulAdd(sum, square, all(d, coefficient));
        }
        const auto series = hn::Mul(hn::Mul(sum, square), cap.arc);
        const auto closed = hn::NegMulAdd(cap.sin_arc, cap.cos_arc, cap.arc);
        return hn::IfThenElse(hn::Lt(cap.arc, all(d, 0.75)), series, closed);
    }
};

/// Circles that do not cross: the light's own zonal integrals, the horizon's, or, where both cover the sphere between
/// them, the sum of both less the whole sphere, which has no bands above 0. The cap's arc and edge, 0 or π, tell.
///
/// part = visit.open(l, share), visit.put(part, m, N_m) for m = l … 1 and visit.close(part, l, N_0,
/// extra): the integral of degree m is share · N_m, and `extra` more for m = 0.
///
/// kAny: for caps that contain the horizon too, and for tilts whose powers would leave the range of T; else `extra` is
/// 0 and costs nothing.
template <class T, bool kAny>
class UncrossedBands {
    using D = Lanes<T>;

  public:
    HWY_INLINE UncrossedBands(const ClippedCap<D>& cap, std::size_t order)
        : cap_(cap),
          light_(cap.cos_half, cap.sin_half, constants_),
          horizon_(cap.height, cap.horizon_sine, constants_),
          turn_(kAny ? cap.cos_tilt : hn::Div(cap.cos_tilt, cap.sin_tilt)),
          square_(hn::Mul(cap.sin_tilt, cap.sin_tilt)) {
        powers_in_lanes<T, kAny>(cap.sin_tilt, order, sine_powers_);
    }

    template <class Visit>
    HWY_INLINE void solve(std::size_t l, Visit& visit) {
        const D d;
        const CapBand<T>& band = constants_.bands[l];
        const auto scale = hn::Set(d, 2 * band.inverse_laplace);
        auto part = visit.open(l, hn::Mul(hn::Mul(scale, cap_.edge), light_.next(l)));
        Down s = diagonal(l);
        for (std::size_t m = l; m > 0; --m) {
            step_down(m, s, visit, part);
        }
        auto extra = hn::Zero(d);
        if constexpr (kAny) {
            extra = hn::Mul(hn::Mul(hn::Mul(scale, cap_.arc), horizon_.next(l)), hn::Set(d, band.at_pole));
        }
        visit.close(part, l, s.n, extra);
    }

  private:
    struct Down {
        V<D> n, n_above;
        V<D> turn;  // here, to stay in a register
        const CapStep<T>* steps;
    };

    /// The start of band l, at m = l.
    HWY_INLINE Down diagonal(std::size_t l) const {
        const D d;
        const auto n = hn::Set(d, constants_.bands[l].diagonal);
        return {kAny ? n : hn::Mul(n, sine_powers_[l]), hn::Zero(d), turn_,
                &constants_.steps[at(static_cast<int>(l), 0)]};
    }

    /// Gives degree m > 0 away and steps to m - 1.
    template <class Visit>
    HWY_INLINE void step_down(std::size_t m, Down& s, Visit& visit, typename Visit::Part& part) const {
        const D d;
        visit.put(part, m, kAny ? hn::Mul(s.n, sine_powers_[m]) : s.n);
        auto back = hn::Mul(hn::Set(d, s.steps[m].down_b), s.n_above);
        back = kAny ? hn::Mul(back, square_) : back;
        s.n_above = s.n;
        s.n = hn::MulSub(hn::Mul(hn::Set(d, s.steps[m].down_a), s.turn), s.n, back);
    }

    const CapConstants<T>& constants_ = CapConstants<T>::get();
    const ClippedCap<D>& cap_;
    ZonalLanes<T> light_, horizon_;
    V<D> turn_, square_;
    DegreeRow<T> sine_powers_;
};

/// Circles that cross. Band by band the turn about the cap's axis gives a three-term recurrence in the degree, with the
/// right side R_m = -sinθ s_0 P̄_l^m(z_0) I_m from the horizon. Its two solutions N (P̄_l^m(cosθ), run downwards) and Q
/// (Q_0 = -N_1, Q_1 = N_0, run upwards) make up Green's function, so that with g = 2 / (c_0 (N_0² + N_1²))
///   X_m = g (N_m p_m + Q_m u_m),   p_m = Σ_{k≤m} Q_k R_k,   u_m = Σ_{k>m} N_k R_k,   R_k less its factor sinθ.
/// N decays where Q grows: Q is summed upwards and N downwards; a prefix difference would lose all digits.
///
/// N̂ = N / sin^m θ and Q̂ = Q sin^{m-1} θ take the place of N and Q, which would leave the range of T; likewise
/// P̂ = P̄ / s_0^m on the horizon.
template <class T>
class CrossedBands {
    using D = Lanes<T>;

  public:
    HWY_INLINE CrossedBands(const ClippedCap<D>& cap, std::size_t order)
        : cap_(cap),
          light_(cap.cos_half, cap.sin_half, constants_),
          arc_(cap, order, constants_),
          turn_(cap.cos_tilt),
          square_(hn::Mul(cap.sin_tilt, cap.sin_tilt)),
          horizon_turn_(cap.height),
          horizon_square_(hn::Mul(cap.horizon_sine, cap.horizon_sine)) {
        powers_in_lanes<T, true>(cap.sin_tilt, order, sine_powers_);
        powers_in_lanes<T, true>(cap.horizon_sine, order, horizon_powers_);
    }

    /// band = visit.open(l), visit.term(band, m, N_m, x_m) for m = 0 … l, visit.close(band, l, g, share, *this): the
    /// integral of degree m is g x_m + share N_m. l ≥ 1.
    template <class Visit>
    HWY_INLINE void solve(std::size_t l, Visit& visit) {
        const D d;
        const CapBand<T>& band = constants_.bands[l];
        const CapStep<T>* steps = &constants_.steps[at(static_cast<int>(l), 0)];
        const auto along_horizon = go_down(l, band, steps);
        const auto n0 = homogeneous_[0];
        const auto n1 = homogeneous_[1];
        const auto n1n1 = hn::Mul(hn::Mul(n1, n1), square_);
        auto green = hn::Div(hn::Set(d, band.casoratian), hn::MulAdd(n0, n0, n1n1));
        green = hn::Mul(green, hn::Mul(cap_.sin_tilt, cap_.horizon_sine));
        auto sums = visit.open(l);
        const auto dot = hn::Mul(go_up(l, steps, visit, sums), green);
        // ∫ P_l(ω·L): Stokes on the Laplacian. Along the light's edge ω·L is constant, along the horizon it is expanded
        // by the addition theorem.
        const auto zonal = hn::MulAdd(hn::Add(cap_.edge, cap_.edge), light_.next(l), along_horizon);
        const auto missing = hn::Mul(hn::Set(d, band.four_pi_over), dot);
        visit.close(sums, l, green, hn::MulSub(zonal, hn::Set(d, band.inverse_laplace), missing), *this);
    }

    /// N_m of the present band.
    HWY_INLINE V<D> homogeneous(std::size_t m) const { return full(homogeneous_[m], m); }

  private:
    struct Down {
        V<D> n, n_above, h, h_above;  // N_m, N_{m+1}; the same on the horizon
        V<D> u, along;
        V<D> turn;  // here, to stay in a register
    };

    HWY_INLINE V<D> lowered(V<D> here, V<D> above, const CapStep<T>& step, V<D> turn, V<D> square) {
        const D d;
        auto back = hn::Mul(hn::Set(d, step.down_b), above);
        back = hn::Mul(back, square);
        return hn::MulSub(hn::Mul(hn::Set(d, step.down_a), turn), here, back);
    }

    /// N_m with its power of sinθ.
    HWY_INLINE V<D> full(V<D> n, std::size_t m) const { return hn::Mul(n, sine_powers_[m]); }

    /// Adds degree m > 0 to the sums and steps to m - 1.
    HWY_INLINE void down_site(std::size_t m, const CapStep<T>& step, Down& s) {
        const D d;
        homogeneous_.put(m, s.n);
        above_.put(m, s.u);
        const auto right = hn::Neg(hn::Mul(hn::Mul(s.h, arc_.moment[m]), horizon_powers_[m]));
        auto slope = hn::Mul(hn::Mul(hn::Set(d, step.ladder), s.h_above), horizon_square_);
        slope = hn::NegMulAdd(hn::Mul(all(d, static_cast<double>(m)), horizon_turn_), s.h, slope);
        slope = hn::Mul(slope, horizon_powers_[m]);
        right_.put(m, right);
        s.u = hn::Mul(hn::MulAdd(s.n, right, s.u), cap_.sin_tilt);
        s.along = hn::MulAdd(full(s.n, m), hn::Mul(slope, arc_.weight[m]), s.along);
        const auto h = lowered(s.h, s.h_above, step, horizon_turn_, horizon_square_);
        s.h_above = s.h;
        s.h = h;
        const auto n = lowered(s.n, s.n_above, step, s.turn, square_);
        s.n_above = s.n;
        s.n = n;
    }

    /// Fills homogeneous_ with N, above_ with u, right_ with R. Returns the horizon's part of l(l+1) ∫ P_l(ω·L).
    HWY_INLINE V<D> go_down(std::size_t l, const CapBand<T>& band, const CapStep<T>* steps) {
        const D d;
        const auto zero = hn::Zero(d);
        const auto diagonal = hn::Set(d, band.diagonal);
        Down s{diagonal, zero, diagonal, zero, zero, zero, turn_};
        for (std::size_t m = l; m > 0; --m) {
            down_site(m, steps[m], s);
        }
        homogeneous_.put(0, s.n);
        above_.put(0, s.u);
        const auto slope = hn::Mul(hn::Mul(hn::Set(d, steps[0].ladder), s.h_above), horizon_square_);
        const auto along = hn::MulAdd(s.n, hn::Mul(slope, arc_.weight[0]), s.along);
        return hn::Mul(hn::Set(d, band.four_pi_over), along);
    }

    struct Up {
        V<D> q, q_below;
        V<D> p, u;
        V<D> dot;
        V<D> turn;  // here, to stay in a register
    };

    /// Adds degree m > 0 and steps to m + 1.
    template <class Visit>
    HWY_INLINE void up_site(std::size_t m, const CapStep<T>& step, Up& s, Visit& visit, typename Visit::Band& sums) {
        const D d;
        s.p = hn::MulAdd(s.q, right_[m], hn::Mul(s.p, cap_.sin_tilt));
        s.u = above_[m];
        const auto n = homogeneous_[m];
        const auto x = hn::MulAdd(n, s.p, hn::Mul(s.q, s.u));
        s.dot = hn::MulAdd(full(n, m), x, s.dot);
        visit.term(sums, m, full(n, m), x);
        auto back = hn::Mul(hn::Set(d, step.up_b), s.q_below);
        back = hn::Mul(back, square_);
        const auto q = hn::MulSub(hn::Mul(hn::Set(d, step.up_a), s.turn), s.q, back);
        s.q_below = s.q;
        s.q = q;
    }

    /// Visits every degree. Returns N · x with the weights 1, 2, 2, … of unnormalised cosine terms.
    template <class Visit>
    HWY_INLINE V<D> go_up(std::size_t l, const CapStep<T>* steps, Visit& visit, typename Visit::Band& sums) {
        const D d;
        const auto n0 = homogeneous_[0];
        const auto u0 = above_[0];
        const auto q0 = hn::Neg(homogeneous_[1]);
        const auto x0 = hn::Mul(q0, u0);
        visit.term(sums, 0, n0, x0);
        Up s{n0, q0, hn::Zero(d), u0, hn::Zero(d), turn_};
        for (std::size_t m = 1; m <= l; ++m) {
            up_site(m, steps[m], s, visit, sums);
        }
        return hn::MulAdd(n0, x0, hn::Add(s.dot, s.dot));
    }

    const CapConstants<T>& constants_ = CapConstants<T>::get();
    const ClippedCap<D>& cap_;
    ZonalLanes<T> light_;
    HorizonIntegrals<T> arc_;
    V<D> turn_, square_, horizon_turn_, horizon_square_;
    DegreeRow<T> sine_powers_, horizon_powers_;
    DegreeRow<T> homogeneous_, above_, right_;
};

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
