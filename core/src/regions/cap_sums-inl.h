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

#include "math/legendre-inl.h"
#include "regions/cap_bands-inl.h"
#include "regions/cap_lanes-inl.h"
#include "regions/cap_sectoral-inl.h"
#include "simd/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace shlight::HWY_NAMESPACE {

/// The recurrences for most caps, and those for the others.
template <class T, bool kCrossing, bool kPlane>
struct BandsOf {
    using Fast = UncrossedBands<T, false>;
    using Fallback = UncrossedBands<T, true>;
};
template <class T, bool kPlane>
struct BandsOf<T, true, kPlane> {
    using Fast = SectoralBands<T, kPlane>;
    using Fallback = CrossedBands<T>;
};

/// Tells which lanes need BandsOf::Fallback.
template <class T>
class BandChoice {
    using D = Lanes<T>;

  public:
    explicit BandChoice(std::size_t order) : sectoral_(order), least_sine_(least_unscaled_sine<T>(order)) {}

    template <bool kCrossing>
    HWY_INLINE M<D> needs_fallback(const ClippedCap<D>& cap) const {
        if constexpr (kCrossing) {
            return sectoral_.beyond(cap);
        } else {
            return hn::Or(hn::Lt(hn::Min(cap.sin_tilt, cap.horizon_sine), all(D(), least_sine_)),
                          hn::Gt(cap.arc, hn::Zero(D())));
        }
    }

  private:
    SectoralRange<T> sectoral_;
    double least_sine_;
};

template <class D>
HWY_INLINE V<D> band_zero(D d, const ClippedCap<D>& cap) {
    return hn::Mul(cap.solid_angle, all(d, std::numbers::inv_sqrtpi / 2));
}

/// √2 cos mφ and √2 sin mφ of the cap's azimuth, 1 and 0 for m = 0.
template <class T>
struct AzimuthLanes {
    alignas(64) std::array<T, static_cast<std::size_t>(kMaxOrder + 1) * kLaneCount<Lanes<T>>> cosine;
    alignas(64) std::array<T, static_cast<std::size_t>(kMaxOrder + 1) * kLaneCount<Lanes<T>>> sine;

    HWY_INLINE AzimuthLanes(const ClippedCap<Lanes<T>>& cap, std::size_t order) {
        complex_powers_in_lanes(Lanes<T>(), cap.cos_azimuth, cap.sin_azimuth, std::numbers::sqrt2, order, cosine.data(),
                                sine.data());
    }
};

/// Writes order² coefficients to each lane's row.
template <class T>
class CoefficientVisitor {
    using D = Lanes<T>;

  public:
    HWY_INLINE CoefficientVisitor(const ClippedCap<D>& cap, std::size_t order, const RowPointers<T>& rows,
                                  Output output)
        : azimuth_(cap, order), writer_(rows, order, output) {
        hn::Store(band_zero(D(), cap), D(), writer_.take(1));
    }

    struct Band {
        T* first;  // place of degree -l
        std::size_t l;
    };
    HWY_INLINE Band open(std::size_t l) { return {writer_.take(2 * l + 1), l}; }
    /// Bands l and l + 1.
    HWY_INLINE std::array<Band, 2> open_two(std::size_t l) {
        T* first = writer_.take(4 * l + 4);
        return {Band{first, l}, Band{first + (2 * l + 1) * kLanes, l + 1}};
    }
    /// The factor of degree m > 0 in any band.
    struct Turn {
        V<D> cosine, sine;
    };
    HWY_INLINE Turn turn(std::size_t m) const {
        return {hn::Load(D(), azimuth_.cosine.data() + m * kLanes), hn::Load(D(), azimuth_.sine.data() + m * kLanes)};
    }
    HWY_INLINE void put_zonal(const Band& band, V<D> value) const {
        hn::Store(value, D(), band.first + band.l * kLanes);
    }
    HWY_INLINE void put(const Band& band, std::size_t m, const Turn& turn, V<D> value) const {
        hn::Store(hn::Mul(value, turn.cosine), D(), band.first + (band.l + m) * kLanes);
        hn::Store(hn::Mul(value, turn.sine), D(), band.first + (band.l - m) * kLanes);
    }
    HWY_INLINE void close(const Band& /*band*/, std::size_t /*l*/) const {}

    /// A band whose values are to be multiplied with `share`.
    struct Part {
        Band band;
        V<D> share;
    };
    HWY_INLINE Part open(std::size_t l, V<D> share) { return {open(l), share}; }
    HWY_INLINE void put(const Part& part, std::size_t m, V<D> homogeneous) const {
        put(part.band, m, turn(m), hn::Mul(part.share, homogeneous));
    }
    HWY_INLINE void close(const Part& part, std::size_t /*l*/, V<D> homogeneous, V<D> extra) const {
        put_zonal(part.band, hn::MulAdd(part.share, homogeneous, extra));
    }

    HWY_INLINE void term(Band& /*band*/, std::size_t m, V<D> /*homogeneous*/, V<D> particular) {
        values_.put(m, particular);
    }
    template <class Bands>
    HWY_INLINE void close(const Band& band, std::size_t l, V<D> green, V<D> share, const Bands& bands) const {
        put_zonal(band, hn::MulAdd(share, bands.homogeneous(0), hn::Mul(green, values_[0])));
        for (std::size_t m = 1; m <= l; ++m) {
            put(band, m, turn(m), hn::MulAdd(share, bands.homogeneous(m), hn::Mul(green, values_[m])));
        }
    }

    void finish() { writer_.finish(); }

  private:
    static constexpr std::size_t kLanes = kLaneCount<D>;

    AzimuthLanes<T> azimuth_;
    RowWriter<T> writer_;
    DegreeRow<T> values_;
};

/// Σ f_lm L_lm for lobes f, a vector for each term: f_lm at terms + cosine_index(l, m) · kLaneCount.
template <class T>
class ShadingVisitor {
    using D = Lanes<T>;

  public:
    HWY_INLINE ShadingVisitor(const ClippedCap<D>& cap, std::size_t order, const T* terms)
        : azimuth_(cap, order), terms_(terms), sum_(hn::Mul(band_zero(D(), cap), hn::Load(D(), terms))) {}

    /// The sums of one band. Of its own, to stay in registers.
    struct Band {
        const T* terms;
        V<D> with_homogeneous, with_particular;
    };
    HWY_INLINE Band open(std::size_t l) const {
        const auto zero = hn::Zero(D());
        return {terms_ + at(static_cast<int>(l), 0) * kLaneCount<D>, zero, zero};
    }
    HWY_INLINE std::array<Band, 2> open_two(std::size_t l) const { return {open(l), open(l + 1)}; }
    /// The factor of degree m > 0 in any band.
    using Turn = V<D>;
    HWY_INLINE Turn turn(std::size_t m) const { return hn::Load(D(), azimuth_.cosine.data() + m * kLaneCount<D>); }
    HWY_INLINE void put_zonal(Band& band, V<D> value) const {
        band.with_homogeneous = hn::MulAdd(hn::Load(D(), band.terms), value, band.with_homogeneous);
    }
    HWY_INLINE void put(Band& band, std::size_t m, const Turn& turn, V<D> value) const {
        band.with_homogeneous = hn::MulAdd(turned(band, m, turn), value, band.with_homogeneous);
    }
    HWY_INLINE void close(const Band& band, std::size_t /*l*/) { sum_ = hn::Add(sum_, band.with_homogeneous); }

    /// A band whose sum is to be multiplied with `share`.
    struct Part {
        Band band;
        V<D> share;
    };
    HWY_INLINE Part open(std::size_t l, V<D> share) const { return {open(l), share}; }
    HWY_INLINE void put(Part& part, std::size_t m, V<D> homogeneous) const { put(part.band, m, turn(m), homogeneous); }
    HWY_INLINE void close(Part& part, std::size_t /*l*/, V<D> homogeneous, V<D> extra) {
        put_zonal(part.band, homogeneous);
        sum_ =
            hn::MulAdd(extra, hn::Load(D(), part.band.terms), hn::MulAdd(part.share, part.band.with_homogeneous, sum_));
    }

    HWY_INLINE void term(Band& band, std::size_t m, V<D> homogeneous, V<D> particular) const {
        const auto t = turned(band, m, turn(m));
        band.with_homogeneous = hn::MulAdd(t, homogeneous, band.with_homogeneous);
        band.with_particular = hn::MulAdd(t, particular, band.with_particular);
    }

    template <class Bands>
    HWY_INLINE void close(const Band& band, std::size_t /*l*/, V<D> green, V<D> share, const Bands& /*bands*/) {
        sum_ = hn::MulAdd(green, band.with_particular, hn::MulAdd(share, band.with_homogeneous, sum_));
    }

    HWY_INLINE V<D> sum() const { return sum_; }

  private:
    static HWY_INLINE V<D> turned(const Band& band, std::size_t m, V<D> turn) {
        return hn::Mul(hn::Load(D(), band.terms + m * kLaneCount<D>), turn);
    }

    AzimuthLanes<T> azimuth_;
    const T* terms_;
    V<D> sum_;
};

/// Bands l and l + 1, together where they can be.
template <class Bands, class Visit>
HWY_INLINE void solve_two_bands(Bands& bands, std::size_t l, Visit& visit) {
    if constexpr (requires { bands.solve_two(l, visit); }) {
        bands.solve_two(l, visit);
    } else {
        bands.solve(l, visit);
        bands.solve(l + 1, visit);
    }
}

/// All bands from 1 on. Order 8, where loops are shortest, has them laid out.
template <class Bands, class Visit>
HWY_INLINE void solve_bands(Bands&& bands, std::size_t order, Visit& visit) {
    if (order == 8) {
        [&]<std::size_t... kPair>(std::index_sequence<kPair...>) HWY_ATTR {
            (solve_two_bands(bands, 2 * kPair + 1, visit), ...);
        }
        (std::make_index_sequence<3>());
        bands.solve(7, visit);
        return;
    }
    std::size_t l = 1;
    for (; l + 1 < order; l += 2) {
        solve_two_bands(bands, l, visit);
    }
    if (l < order) {
        bands.solve(l, visit);
    }
}

}  // namespace shlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
