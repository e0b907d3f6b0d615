// SPDX-License-Identifier: MIT
//
// What is done with the bands of caps in lanes: written out as coefficients, or multiplied with lobes. Included once
// per instruction set.
#if defined(SHLIGHT_KERNELS_CAP_SUMS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SHLIGHT_KERNELS_CAP_SUMS_INL_H_
#undef SHLIGHT_KERNELS_CAP_SUMS_INL_H_
#else
#define SHLIGHT_KERNELS_CAP_SUMS_INL_H_
#endif

#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <numbers>
#include <utility>

#include "kernels/cap_bands-inl.h"
#include "kernels/cap_lanes-inl.h"
#include "kernels/cap_sectoral-inl.h"
#include "kernels/legendre-inl.h"
#include "kernels/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// The recurrences for most caps, and those for the others.
template <class T, bool kCrossing, bool kPlane, bool kMayContainHorizon>
struct BandsOf {
    using Most = UncrossedBands<T, false, kMayContainHorizon>;
    using Others = UncrossedBands<T, true, kMayContainHorizon>;
};
template <class T, bool kPlane, bool kMayContainHorizon>
struct BandsOf<T, true, kPlane, kMayContainHorizon> {
    using Most = SectoralBands<T, kPlane>;
    using Others = CrossedBands<T, kPlane>;
};

/// Tells which lanes need BandsOf::Others.
template <class T>
class BandChoice {
    using D = Lanes<T>;

  public:
    explicit BandChoice(std::size_t order) : sectoral_(order), least_sine_(least_unscaled_sine<T>(order)) {}

    template <bool kCrossing>
    HWY_INLINE M<D> others(const CapLanes<D>& cap) const {
        if constexpr (kCrossing) {
            return sectoral_.beyond(cap);
        } else {
            return hn::Lt(hn::Min(cap.sin_tilt, cap.horizon_sine), all(D(), least_sine_));
        }
    }

  private:
    SectoralRange<T> sectoral_;
    double least_sine_;
};

template <class D>
HWY_INLINE V<D> band_zero(D d, const CapLanes<D>& cap) {
    return hn::Mul(cap.solid_angle, all(d, std::numbers::inv_sqrtpi / 2));
}

/// √2 cos mφ and √2 sin mφ of the cap's azimuth, 1 and 0 for m = 0.
template <class T>
struct AzimuthLanes {
    alignas(64) std::array<T, static_cast<std::size_t>(kMaxOrder + 1) * kLaneCount<Lanes<T>>> cosine;
    alignas(64) std::array<T, static_cast<std::size_t>(kMaxOrder + 1) * kLaneCount<Lanes<T>>> sine;

    HWY_INLINE AzimuthLanes(const CapLanes<Lanes<T>>& cap, std::size_t order) {
        complex_powers_in_lanes(Lanes<T>(), cap.cos_azimuth, cap.sin_azimuth, std::numbers::sqrt2, order, cosine.data(),
                                sine.data());
    }
};

/// Writes order² coefficients to each lane's row.
template <class T>
class CoefficientVisitor {
    using D = Lanes<T>;

  public:
    HWY_INLINE CoefficientVisitor(const CapLanes<D>& cap, std::size_t order, const RowPointers<T>& rows, Output output)
        : azimuth_(cap, order), writer_(rows, order, output) {
        hn::Store(band_zero(D(), cap), D(), writer_.next());
        writer_.add(1);
    }

    struct Band {
        T* first;  // where degree -l goes
        std::size_t l;
    };
    HWY_INLINE Band open(std::size_t l) { return {writer_.next(), l}; }
    HWY_INLINE void put(const Band& band, std::size_t m, V<D> value) const {
        const D d;
        constexpr std::size_t kLanes = kLaneCount<D>;
        T* right = band.first + (band.l + m) * kLanes;
        if (m == 0) {
            hn::Store(value, d, right);
            return;
        }
        T* left = band.first + (band.l - m) * kLanes;
        hn::Store(hn::Mul(value, hn::Load(d, azimuth_.cosine.data() + m * kLanes)), d, right);
        hn::Store(hn::Mul(value, hn::Load(d, azimuth_.sine.data() + m * kLanes)), d, left);
    }
    HWY_INLINE void term(Band& /*band*/, std::size_t m, V<D> null) { values_.put(m, null); }
    HWY_INLINE void term(Band& /*band*/, std::size_t m, V<D> /*null*/, V<D> particular) { values_.put(m, particular); }

    HWY_INLINE void close(const Band& /*band*/, std::size_t l) { writer_.add(2 * l + 1); }
    /// Of circles that do not cross.
    HWY_INLINE void close(const Band& band, std::size_t l, V<D> share, V<D> extra) {
        put(band, 0, hn::MulAdd(share, values_[0], extra));
        for (std::size_t m = 1; m <= l; ++m) {
            put(band, m, hn::Mul(share, values_[m]));
        }
        close(band, l);
    }
    template <class Bands>
    HWY_INLINE void close(const Band& band, std::size_t l, V<D> green, V<D> share, const Bands& bands) {
        for (std::size_t m = 0; m <= l; ++m) {
            put(band, m, hn::MulAdd(share, bands.null(m), hn::Mul(green, values_[m])));
        }
        close(band, l);
    }

    void finish() { writer_.finish(); }

  private:
    AzimuthLanes<T> azimuth_;
    RowWriter<T> writer_;
    DegreeRow<T> values_;
};

/// Σ f_lm L_lm for lobes f, a vector for each term: f_lm at terms + cosine_index(l, m) · kLaneCount.
template <class T>
class ShadingVisitor {
    using D = Lanes<T>;

  public:
    HWY_INLINE ShadingVisitor(const CapLanes<D>& cap, std::size_t order, const T* terms)
        : terms_(terms), sum_(hn::Mul(band_zero(D(), cap), hn::Load(D(), terms))) {
        const D d;
        const auto x = cap.cos_azimuth;
        const auto y = cap.sin_azimuth;
        auto re = hn::Mul(x, all(d, std::numbers::sqrt2));
        auto im = hn::Mul(y, all(d, std::numbers::sqrt2));
        cosine_.put(0, all(d, 1));
        for (std::size_t m = 1; m < order; ++m) {
            cosine_.put(m, re);
            const auto next = hn::MulSub(re, x, hn::Mul(im, y));
            im = hn::MulAdd(re, y, hn::Mul(im, x));
            re = next;
        }
    }

    /// The sums of one band. Of its own, to stay in registers.
    struct Band {
        const T* terms;
        V<D> with_null, with_particular;
    };
    HWY_INLINE Band open(std::size_t l) const {
        const auto zero = hn::Zero(D());
        return {terms_ + at(static_cast<int>(l), 0) * kLaneCount<D>, zero, zero};
    }
    HWY_INLINE void put(Band& band, std::size_t m, V<D> value) const {
        band.with_null = hn::MulAdd(turned(band, m), value, band.with_null);
    }
    HWY_INLINE void term(Band& band, std::size_t m, V<D> null) const {
        band.with_null = hn::MulAdd(turned(band, m), null, band.with_null);
    }
    HWY_INLINE void term(Band& band, std::size_t m, V<D> null, V<D> particular) const {
        const auto t = turned(band, m);
        band.with_null = hn::MulAdd(t, null, band.with_null);
        band.with_particular = hn::MulAdd(t, particular, band.with_particular);
    }

    HWY_INLINE void close(const Band& band, std::size_t /*l*/) { sum_ = hn::Add(sum_, band.with_null); }
    HWY_INLINE void close(const Band& band, std::size_t /*l*/, V<D> share, V<D> extra) {
        sum_ = hn::MulAdd(extra, hn::Load(D(), band.terms), hn::MulAdd(share, band.with_null, sum_));
    }
    template <class Bands>
    HWY_INLINE void close(const Band& band, std::size_t /*l*/, V<D> green, V<D> share, const Bands& /*bands*/) {
        sum_ = hn::MulAdd(green, band.with_particular, hn::MulAdd(share, band.with_null, sum_));
    }

    HWY_INLINE V<D> sum() const { return sum_; }

  private:
    HWY_INLINE V<D> turned(const Band& band, std::size_t m) const {
        const D d;
        return hn::Mul(hn::Load(d, band.terms + m * kLaneCount<D>), cosine_[m]);
    }

    DegreeRow<T> cosine_;  // √2 cos mφ, 1 for m = 0
    const T* terms_;
    V<D> sum_;
};

/// All bands from 1 on. Order 8, where loops are shortest, has them laid out.
template <class Bands, class Visit>
HWY_INLINE void solve_bands(Bands&& bands, std::size_t order, Visit& visit) {
    if (order == 8) {
        [&]<std::size_t... kBand>(std::index_sequence<kBand...>) HWY_ATTR {
            (bands.solve(kBand + 1, visit), ...);
        }
        (std::make_index_sequence<7>());
        return;
    }
    for (std::size_t l = 1; l < order; ++l) {
        bands.solve(l, visit);
    }
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
