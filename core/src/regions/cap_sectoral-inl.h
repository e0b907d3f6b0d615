// SPDX-License-Identifier: MIT
//
// The integrals of the basis over caps that cross the horizon, from each band's highest degree downwards
// (docs/theory.md, 3.4). Included once per instruction set.
#if defined(SHLIGHT_KERNELS_CAP_SECTORAL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_CAP_SECTORAL_INL_H_
#undef SHLIGHT_KERNELS_CAP_SECTORAL_INL_H_
#else
#define SHLIGHT_KERNELS_CAP_SECTORAL_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "regions/cap_bands-inl.h"
#include "regions/cap_constants.h"
#include "regions/cap_lanes-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// The lanes in which SectoralBands keeps its digits. Down from m = l to m = l sinθ an error grows as P̄_l^m(cosθ) does,
/// by
/// ((1 + |cosθ|) e^{-|cosθ|} / sinθ)^l (the leading term of its asymptotics). It starts as a rounding of X_l, which is
/// of the size of t^l for the largest sine t of an angle to the pole in the region: s_0 above a high horizon, else up
/// to 1.
template <class T>
class SectoralRange {
    using D = Lanes<T>;

  public:
    explicit SectoralRange(std::size_t order)
        : largest_ratio_(static_cast<T>(std::exp(kMostGrowth / std::max(1.0, static_cast<double>(order) - 1)))),
          least_sine_(static_cast<T>(least_unscaled_sine<T>(order))) {}

    HWY_INLINE M<D> beyond(const ClippedCap<D>& cap) const {
        const D d;
        const auto c = hn::Abs(cap.cos_tilt);
        // 1 - (1 + c) e^{-c} over c², to 0.005.
        const auto deficit = hn::NegMulAdd(hn::NegMulAdd(all(d, 0.1), c, all(d, 1.0 / 3)), c, all(d, 0.5));
        const auto growth = hn::NegMulAdd(hn::Mul(c, c), deficit, all(d, 1));
        return hn::Or(hn::Gt(hn::Mul(growth, reach(cap, c)), hn::Mul(cap.sin_tilt, hn::Set(d, largest_ratio_))),
                      hn::Lt(cap.horizon_sine, hn::Set(d, least_sine_)));
    }

  private:
    static constexpr double kMostGrowth = 3;  // logarithm of the growth

    /// Off the equator the cap reaches sin(θ ± σ), above a high horizon no region s_0.
    static HWY_INLINE V<D> reach(const ClippedCap<D>& cap, V<D> cosine) {
        const D d;
        const auto off_equator = hn::And(hn::Gt(cosine, cap.sin_half), hn::Gt(cap.cos_half, hn::Zero(d)));
        const auto nearest = hn::MulAdd(cap.sin_tilt, cap.cos_half, hn::Mul(cosine, cap.sin_half));
        const auto own = hn::IfThenElse(off_equator, nearest, all(d, 1));
        return hn::IfThenElse(hn::Gt(cap.height, hn::Zero(d)), hn::Min(own, cap.horizon_sine), own);
    }

    T largest_ratio_, least_sine_;
};

/// Circles that cross. The integral of degree l is known by itself: (x+iy)^l is harmonic and has no slope along z, so
/// that Stokes' theorem leaves little but the light's edge. With J_l = ∫ Re (x+iy)^l dψ along the edge and
/// G_l = (l+1) ∫ Re (x+iy)^l dω, J_0 = 2ψ_0 and G_0 = 0,
///   J_l = sinθ (cosσ J_{l-1} - (l-1)/l G_{l-1}) - (2/l) s_0^l sin lφ_a cosθ
///   G_l = sinθ ((l-1)/l cosσ G_{l-1} + sin²σ J_{l-1}) - (2/l) s_0^l sin lφ_a (z_0 - cosσ cosθ).
/// G is what sinθ J_{l-1} - cosσ J_l less the horizon's part would be, without their cancellation for small lights; and
/// the three-term recurrence of J alone would amplify roundings by l² for them.
/// From there the turn about the cap's axis (CrossedBands) gives one degree after the other:
///   X_{m-1} = (2m/c_{m-1}) cotθ X_m - (c_m/c_{m-1}) X_{m+1} + (2/c_{m-1}) s_0 P̄_l^m(z_0) I_m.
///
/// kPlane: the horizon is z = 0.
template <class T, bool kPlane>
class SectoralBands {
    using D = Lanes<T>;

  public:
    HWY_INLINE SectoralBands(const ClippedCap<D>& cap, std::size_t order)
        : arc_(cap, order, constants_), turn_(hn::Div(cap.cos_tilt, cap.sin_tilt)) {
        const D d;
        const auto half = all(d, 0.5);
        sine_ = cap.sin_tilt;
        across_ = hn::Mul(cap.cos_half, cap.sin_tilt);
        own_ = hn::Mul(hn::Mul(cap.sin_half, cap.sin_half), cap.sin_tilt);
        tilt_ = hn::Mul(cap.cos_tilt, half);
        edge_height_ = hn::Mul(cap.edge_height, half);
        edge_ = hn::Add(cap.edge, cap.edge);
        sectoral_ = hn::Zero(d);
        if constexpr (!kPlane) {
            horizon_sine_ = cap.horizon_sine;
            horizon_turn_ = hn::Div(cap.height, cap.horizon_sine);
            power_ = all(d, 1);
        }
    }

    /// band = visit.open(l); visit.put(band, m, visit.turn(m), X_m) for m = l … 1; visit.put_zonal(band, X_0) and
    /// visit.close(band, l). l ≥ 1, one after the other.
    template <class Visit>
    HWY_INLINE void solve(std::size_t l, Visit& visit) {
        Down s = sectoral(l);
        auto band = visit.open(l);
        std::size_t m = l;
        for (; m >= 2; m -= 2) {
            step_down<true>(m, s, visit, band, visit.turn(m));
            step_down<!kPlane>(m - 1, s, visit, band, visit.turn(m - 1));
        }
        if (m == 1) {
            step_down<true>(1, s, visit, band, visit.turn(1));
        }
        visit.put_zonal(band, s.x);
        visit.close(band, l);
    }

    /// The same for bands l and l + 1, opened by visit.open_two(l). One fills the time in which the other waits for its
    /// next degree, and they share what the visitor turns by. At other horizons each has work enough of its own.
    template <class Visit>
    requires(kPlane) HWY_INLINE void solve_two(std::size_t l, Visit& visit) {
        Down a = sectoral(l);
        Down b = sectoral(l + 1);
        auto bands = visit.open_two(l);
        step_down<true>(l + 1, b, visit, bands[1], visit.turn(l + 1));
        std::size_t m = l;
        for (; m >= 2; m -= 2) {
            const auto turn = visit.turn(m);
            step_down<true>(m, a, visit, bands[0], turn);
            step_down<false>(m, b, visit, bands[1], turn);
            const auto next_turn = visit.turn(m - 1);
            step_down<false>(m - 1, a, visit, bands[0], next_turn);
            step_down<true>(m - 1, b, visit, bands[1], next_turn);
        }
        if (m == 1) {
            const auto turn = visit.turn(1);
            step_down<true>(1, a, visit, bands[0], turn);
            step_down<false>(1, b, visit, bands[1], turn);
        }
        visit.put_zonal(bands[0], a.x);
        visit.close(bands[0], l);
        visit.put_zonal(bands[1], b.x);
        visit.close(bands[1], l + 1);
    }

  private:
    struct Down {
        V<D> x, x_above;
        V<D> horizon, horizon_above;  // s_0 P̄_l^m(z_0) of the same degrees
        V<D> turn;                    // here, to stay in a register
        const CapStep<T>* steps;
    };

    /// The start of band l, after band l - 1.
    HWY_INLINE Down sectoral(std::size_t l) {
        const D d;
        const CapBand<T>& band = constants_.bands[l];
        Down s{next_sectoral(l, band),
               hn::Zero(d),
               hn::Zero(d),
               hn::Zero(d),
               turn_,
               &constants_.steps[at(static_cast<int>(l), 0)]};
        if constexpr (!kPlane) {
            s.horizon = hn::Mul(hn::Set(d, band.diagonal), hn::Mul(power_, horizon_sine_));
        }
        return s;
    }

    /// X_l of band l, after that of band l - 1.
    HWY_INLINE V<D> next_sectoral(std::size_t l, const CapBand<T>& band) {
        const D d;
        const auto keep = hn::Set(d, band.rise_a);
        auto weight = arc_.weight[l];
        if constexpr (!kPlane) {
            power_ = hn::Mul(power_, horizon_sine_);
            weight = hn::Mul(weight, power_);
        }
        const auto before = hn::Mul(keep, sectoral_);
        sectoral_ = hn::MulAdd(across_, before, hn::NegMulAdd(edge_height_, weight, hn::Mul(own_, edge_)));
        edge_ = hn::MulSub(across_, edge_, hn::MulAdd(sine_, before, hn::Mul(tilt_, weight)));
        return hn::Mul(hn::Set(d, band.sectoral), sectoral_);
    }

    /// Gives degree m > 0 away and steps to m - 1. kValue: whether the horizon has a value there.
    template <bool kValue, class Visit>
    HWY_INLINE void step_down(std::size_t m, Down& s, Visit& visit, typename Visit::Band& band,
                              const typename Visit::Turn& by) {
        const D d;
        const CapStep<T>& step = s.steps[m];
        visit.put(band, m, by, s.x);
        const auto ahead = hn::Set(d, step.down_a);
        const auto back = hn::Set(d, step.down_b);
        const auto turn = hn::Mul(ahead, s.turn);
        V<D> below;
        if constexpr (kPlane && !kValue) {
            below = hn::MulSub(turn, s.x, hn::Mul(back, s.x_above));
        } else {
            // The horizon's share comes first, and each degree then is two multiply-adds away from the one before the
            // last, without a product between them: in long bands the next degree waits for nothing else.
            auto given = hn::Mul(hn::Set(d, kPlane ? step.down_plane : step.down_share), arc_.moment[m]);
            if constexpr (!kPlane) {
                given = hn::Mul(given, s.horizon);
            }
            below = hn::MulAdd(turn, s.x, hn::NegMulAdd(back, s.x_above, given));
        }
        if constexpr (!kPlane) {
            const auto horizon = hn::MulSub(hn::Mul(ahead, horizon_turn_), s.horizon, hn::Mul(back, s.horizon_above));
            s.horizon_above = s.horizon;
            s.horizon = horizon;
        }
        s.x_above = s.x;
        s.x = below;
    }

    const CapConstants<T>& constants_ = CapConstants<T>::get();
    HorizonIntegrals<T> arc_;
    V<D> turn_;                         // cotθ
    V<D> sine_, across_, own_;          // sinθ, cosσ sinθ, sin²σ sinθ
    V<D> tilt_, edge_height_;           // cosθ / 2, (z_0 - cosσ cosθ) / 2
    V<D> edge_, sectoral_;              // J_l, G_l
    V<D> horizon_sine_, horizon_turn_;  // s_0, z_0 / s_0
    V<D> power_;                        // s_0^l
};

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
