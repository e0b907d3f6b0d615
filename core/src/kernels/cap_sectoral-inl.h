// SPDX-License-Identifier: MIT
//
// The integrals of the basis over caps that cross the horizon, from each band's highest degree downwards
// (docs/algorithms.md, "Caps from their sectoral terms"). Included once per instruction set.
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

#include "kernels/cap_bands-inl.h"
#include "kernels/cap_constants.h"
#include "kernels/cap_lanes-inl.h"
#include "kernels/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// Where SectoralBands keeps its digits. Down from m = l to m = l sinθ an error grows as P̄_l^m(cosθ) does, by
/// ((1 + |cosθ|) e^{-|cosθ|} / sinθ)^l (the leading term of its asymptotics). It starts as a rounding of X_l, which is
/// of the size of t^l for the largest sine t of an angle to the pole in the region: s_0 above a high horizon, else up
/// to 1.
template <class T>
class SectoralRange {
    using D = Lanes<T>;

  public:
    explicit SectoralRange(std::size_t order)
        : most_(static_cast<T>(std::exp(kMostGrowth / std::max(1.0, static_cast<double>(order) - 1)))),
          least_sine_(static_cast<T>(least_unscaled_sine<T>(order))) {}

    HWY_INLINE M<D> beyond(const CapLanes<D>& cap) const {
        const D d;
        const auto c = hn::Abs(cap.cos_tilt);
        // 1 - (1 + c) e^{-c} over c², to 0.005.
        const auto lack = hn::NegMulAdd(hn::NegMulAdd(all(d, 0.1), c, all(d, 1.0 / 3)), c, all(d, 0.5));
        const auto climb = hn::NegMulAdd(hn::Mul(c, c), lack, all(d, 1));
        return hn::Or(hn::Gt(hn::Mul(climb, reach(cap, c)), hn::Mul(cap.sin_tilt, hn::Set(d, most_))),
                      hn::Lt(cap.horizon_sine, hn::Set(d, least_sine_)));
    }

  private:
    static constexpr double kMostGrowth = 3;  // of its logarithm

    /// Off the equator the cap reaches sin(θ ± σ), above a high horizon no region s_0.
    static HWY_INLINE V<D> reach(const CapLanes<D>& cap, V<D> cosine) {
        const D d;
        const auto off_equator = hn::And(hn::Gt(cosine, cap.sin_half), hn::Gt(cap.cos_half, hn::Zero(d)));
        const auto nearest = hn::MulAdd(cap.sin_tilt, cap.cos_half, hn::Mul(cosine, cap.sin_half));
        const auto own = hn::IfThenElse(off_equator, nearest, all(d, 1));
        return hn::IfThenElse(hn::Gt(cap.height, hn::Zero(d)), hn::Min(own, cap.horizon_sine), own);
    }

    T most_, least_sine_;
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
    HWY_INLINE SectoralBands(const CapLanes<D>& cap, std::size_t order)
        : arc_(cap, order), turn_(hn::Div(cap.cos_tilt, cap.sin_tilt)) {
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

    /// band = visit.open(l), visit.put(band, m, X_m) for m = l … 0, visit.close(band, l). l ≥ 1, one after the other.
    template <class Visit>
    HWY_INLINE void solve(std::size_t l, Visit& visit) {
        const D d;
        const CapConstants<T>& constants = CapConstants<T>::get();
        const CapStep<T>* steps = &constants.steps[at(static_cast<int>(l), 0)];
        auto band = visit.open(l);
        Down s{next_sectoral(l, constants.bands[l]), hn::Zero(d), hn::Zero(d), hn::Zero(d), turn_};
        if constexpr (!kPlane) {
            s.horizon = hn::Mul(hn::Set(d, constants.bands[l].diagonal), hn::Mul(power_, horizon_sine_));
        }
        std::size_t m = l;
        for (; m >= 2; m -= 2) {
            step_down<true>(m, steps[m], s, visit, band);
            step_down<!kPlane>(m - 1, steps[m - 1], s, visit, band);
        }
        if (m == 1) {
            step_down<true>(1, steps[1], s, visit, band);
        }
        visit.put(band, 0, s.x);
        visit.close(band, l);
    }

  private:
    struct Down {
        V<D> x, x_above;
        V<D> horizon, horizon_above;  // s_0 P̄_l^m(z_0) of the same degrees
        V<D> turn;                    // here, to stay in a register
    };

    /// X_l of band l, after that of band l - 1.
    HWY_INLINE V<D> next_sectoral(std::size_t l, const CapBand<T>& band) {
        const D d;
        const auto keep = hn::Set(d, band.keep_rise);
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
    HWY_INLINE void step_down(std::size_t m, const CapStep<T>& step, Down& s, Visit& visit,
                              typename Visit::Band& band) {
        const D d;
        visit.put(band, m, s.x);
        auto rest = hn::Mul(hn::Set(d, step.down_fall), s.x_above);
        if constexpr (kPlane && kValue) {
            rest = hn::NegMulAdd(hn::Set(d, step.down_plane), arc_.moment[m], rest);
        }
        if constexpr (!kPlane) {
            rest = hn::NegMulAdd(hn::Mul(hn::Set(d, step.down_share), arc_.moment[m]), s.horizon, rest);
            const auto fall = hn::Mul(hn::Set(d, step.down_fall), s.horizon_above);
            s.horizon_above = s.horizon;
            s.horizon = hn::MulSub(hn::Mul(hn::Set(d, step.down_climb), horizon_turn_), s.horizon, fall);
        }
        const auto below = hn::MulSub(hn::Mul(hn::Set(d, step.down_climb), s.turn), s.x, rest);
        s.x_above = s.x;
        s.x = below;
    }

    ArcLanes<T> arc_;
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
