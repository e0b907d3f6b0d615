// SPDX-License-Identifier: MIT
//
// The integrals of the basis over a cap and a horizon, band by band (docs/algorithms.md, "Caps").
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "band_system.h"
#include "legendre.h"
#include "shlight/cap.h"

namespace shlight {
namespace {

/// The zonal integrals λ_l of an unclipped cap, ∫ P_l(ω·L) dω (Funk–Hecke), from l = 1 on.
/// λ_l = 2π sin²σ P_l'(cosσ) / (l(l+1)) is 2π (P_{l-1} - P_{l+1}) / (2l+1) without its cancellation.
/// For small caps P_l falls from 1 by l(l+1)/2 · (1 - cosσ): the recurrence runs on the differences P_l - P_{l-1} and
/// on 1 - cosσ = sin²σ / (1 + cosσ), because a rounded cosσ would be amplified by l². Large caps are the mirror image,
/// P_l'(-x) = (-1)^{l+1} P_l'(x).
template <class T>
class ZonalIntegrals {
  public:
    ZonalIntegrals(T cos_half, T sin_half)
        : sin2_(sin_half * sin_half), lack_(sin2_ / (1 + std::abs(cos_half))), mirrored_(cos_half < 0) {}

    /// sin²σ P_l'(cosσ) for l = 1, 2, 3 … in turn.
    T next_edge() {
        ++l_;
        const T derivative = derivative_before_ + static_cast<T>(2 * l_ - 1) * p_;  // P'_l = P'_{l-2} + (2l-1) P_{l-1}
        derivative_before_ = derivative_;
        derivative_ = derivative;
        rise_ = (static_cast<T>(l_ - 1) * rise_ - static_cast<T>(2 * l_ - 1) * lack_ * p_) / static_cast<T>(l_);
        p_ += rise_;
        return mirrored_ && l_ % 2 == 0 ? -sin2_ * derivative : sin2_ * derivative;
    }

  private:
    T sin2_, lack_;
    bool mirrored_;
    int l_ = 0;
    T p_ = 1, rise_ = 0;                        // P_l, P_l - P_{l-1} at |cosσ|
    T derivative_before_ = 0, derivative_ = 0;  // P'_{l-1}, P'_l
};

/// Integrals along the horizon's covered arc |φ| ≤ φ_a.
template <class T>
struct HorizonArc {
    std::array<T, kMaxOrder + 1> cosine;  ///< ∫ cos mφ dφ, twice that for m > 0
    std::array<T, kMaxOrder> moment;      ///< ∫ sin mφ sin φ dφ

    HorizonArc(const Cap<T>& cap, int order) {
        std::array<T, kMaxOrder + 1> unused, sine_over_m;
        complex_powers(cap.cos_arc, cap.sin_arc, order + 1, unused.data(), sine_over_m.data());
        sine_over_m[0] = cap.arc;
        cosine[0] = 2 * cap.arc;
        for (int m = 1; m <= order; ++m) {
            sine_over_m[m] /= static_cast<T>(m);
            cosine[m] = 4 * sine_over_m[m];
        }
        moment[0] = 0;
        for (int m = 1; m < order; ++m) {
            moment[m] = static_cast<T>(m + 1) * cap.arc < T(0.6) ? moment_series(m, cap.arc)
                                                                 : sine_over_m[m - 1] - sine_over_m[m + 1];
        }
    }

  private:
    /// The power series of sin((m-1)φ)/(m-1) - sin((m+1)φ)/(m+1), whose two terms agree to φ³ for short arcs.
    static T moment_series(int m, T arc) {
        const T low = static_cast<T>((m - 1) * (m - 1));
        const T high = static_cast<T>((m + 1) * (m + 1));
        T term = arc, low_power = 1, high_power = 1, sum = 0;
        for (int j = 1; j < 8; ++j) {
            term *= -arc * arc / static_cast<T>(2 * j * (2 * j + 1));
            low_power *= low;
            high_power *= high;
            sum += term * (low_power - high_power);
        }
        return sum;
    }
};

/// The integrals ∫ P̄_l^m cos mφ of one band, m = 0 … l, about the azimuth of the cap's axis, in two parts whose sum
/// is left to whoever wants it.
template <class T>
struct Band {
    const T* particular;
    const T* null;  // P̄_l^m(cosθ), the zonal function about the cap's axis
    T share;

    T operator[](int m) const { return particular[m] + share * null[m]; }
};

/// Circles that do not cross: the light's own zonal integrals, the horizon's, or, where both cover the sphere between
/// them, the sum of both less the whole sphere, which has no bands above 0.
template <class T, class Visit>
void uncrossed_bands(const Cap<T>& cap, const Horizon<T>& horizon, int order, const Visit& visit) {
    LegendreRows<T> legendre(cap.cos_tilt, cap.sin_tilt * cap.sin_tilt);
    ZonalIntegrals<T> zonal(cap.cos_half, cap.sin_half);
    std::array<T, kMaxOrder> sin_tilt_powers, null, particular;
    std::fill_n(particular.begin(), order, T(0));
    powers(cap.sin_tilt, order, sin_tilt_powers.data());
    for (int l = 1; l < order; ++l) {
        legendre.advance();
        for (int m = 0; m <= l; ++m) {
            null[m] = legendre[m] * sin_tilt_powers[m];
        }
        const T scale = 2 * std::numbers::pi_v<T> / static_cast<T>(l * (l + 1));
        particular[0] = cap.arc > 0 ? scale * horizon.slopes(l)[0] : T(0);
        visit(l, Band<T>{particular.data(), null.data(), cap.edge > 0 ? scale * zonal.next_edge() : T(0)});
    }
}

template <class T, class Visit>
void crossed_bands(const Cap<T>& cap, const Horizon<T>& horizon, int order, const Visit& visit) {
    const HorizonArc<T> arc(cap, order);
    LegendreRows<T> legendre(cap.cos_tilt, cap.sin_tilt * cap.sin_tilt);
    ZonalIntegrals<T> zonal(cap.cos_half, cap.sin_half);
    std::array<T, kMaxOrder> sin_tilt_powers, right, null, particular;
    powers(cap.sin_tilt, order, sin_tilt_powers.data());
    for (int l = 1; l < order; ++l) {
        legendre.advance();
        const T* values = horizon.values(l);
        const T* slopes = horizon.slopes(l);
        T along_horizon = 0;
        for (int m = 0; m <= l; ++m) {
            null[m] = legendre[m] * sin_tilt_powers[m];
            right[m] = -cap.sin_tilt * values[m] * arc.moment[m];
            along_horizon += slopes[m] * arc.cosine[m] * null[m];
        }
        // ∫ P_l(ω·L): Stokes on the Laplacian. Along the light's edge ω·L is constant, along the horizon it is expanded
        // by the addition theorem.
        const T four_pi_over = 4 * std::numbers::pi_v<T> / static_cast<T>(2 * l + 1);
        const T zonal_integral =
            (2 * cap.edge * zonal.next_edge() + four_pi_over * along_horizon) / static_cast<T>(l * (l + 1));
        BandSystem<T>(l, cap.cos_tilt, cap.sin_tilt, legendre.row()).solve(right.data(), particular.data());
        const T share = missing_null_component(l, null.data(), zonal_integral, particular.data());
        visit(l, Band<T>{particular.data(), null.data(), share});
    }
}

/// visit(l, band) for each band from 1 on.
template <class T, class Visit>
void for_each_band(const Cap<T>& cap, const Horizon<T>& horizon, int order, const Visit& visit) {
    if (cap.crossing) {
        crossed_bands(cap, horizon, order, visit);
    } else {
        uncrossed_bands(cap, horizon, order, visit);
    }
}

template <class T>
T band_zero(const Cap<T>& cap) {
    return cap.solid_angle * LegendreConstants<T>::get().diagonal[0];
}

/// √2 cos mφ and √2 sin mφ of the cap's azimuth, 1 and 0 for m = 0.
template <class T>
struct Azimuth {
    std::array<T, kMaxOrder> cosine, sine;

    Azimuth(const Cap<T>& cap, int order) {
        complex_powers(cap.cos_azimuth, cap.sin_azimuth, order, cosine.data(), sine.data());
        for (int m = 1; m < order; ++m) {
            cosine[m] *= std::numbers::sqrt2_v<T>;
            sine[m] *= std::numbers::sqrt2_v<T>;
        }
    }
};

}  // namespace

template <class T>
void clipped_cap_terms(const Cap<T>& cap, const Horizon<T>& horizon, int order, T* cosine_terms) {
    cosine_terms[0] = band_zero(cap);
    for_each_band(cap, horizon, order, [&](int l, const Band<T>& band) {
        T* terms = cosine_terms + cosine_index(l, 0);
        terms[0] = band[0];
        for (int m = 1; m <= l; ++m) {
            terms[m] = std::numbers::sqrt2_v<T> * band[m];
        }
    });
}

template <class T>
T shade_cap(const Cap<T>& cap, const Horizon<T>& horizon, const T* lobe_terms, int order) {
    if (cap.solid_angle <= 0) {
        return 0;
    }
    const Azimuth<T> azimuth(cap, order);
    T radiance = lobe_terms[0] * band_zero(cap);
    for_each_band(cap, horizon, order, [&](int l, const Band<T>& band) {
        const T* terms = lobe_terms + cosine_index(l, 0);
        T with_particular = 0;
        T with_null = 0;
        for (int m = 0; m <= l; ++m) {
            const T turned = terms[m] * azimuth.cosine[m];
            with_particular += turned * band.particular[m];
            with_null += turned * band.null[m];
        }
        radiance += with_particular + band.share * with_null;
    });
    return radiance;
}

template <class T>
void cap_coefficients(const Cap<T>& cap, int order, bool clip, T* coefficients) {
    const Cap<T> kept = clip ? cap : cap.unclipped();
    if (kept.solid_angle <= 0) {
        std::fill_n(coefficients, coefficient_count(order), T(0));
        return;
    }
    coefficients[0] = band_zero(kept);
    if (order == 1) {
        return;
    }
    const Azimuth<T> azimuth(cap, order);
    for_each_band(kept, Horizon<T>::plane(), order, [&](int l, const Band<T>& band) {
        T* out = coefficients + coefficient_index(l, 0);
        out[0] = band[0];
        for (int m = 1; m <= l; ++m) {
            const T value = band[m];
            out[m] = value * azimuth.cosine[m];
            out[-m] = value * azimuth.sine[m];
        }
    });
}

template void clipped_cap_terms(const Cap<float>&, const Horizon<float>&, int, float*);
template void clipped_cap_terms(const Cap<double>&, const Horizon<double>&, int, double*);
template float shade_cap(const Cap<float>&, const Horizon<float>&, const float*, int);
template double shade_cap(const Cap<double>&, const Horizon<double>&, const double*, int);
template void cap_coefficients(const Cap<float>&, int, bool, float*);
template void cap_coefficients(const Cap<double>&, int, bool, double*);

}  // namespace shlight
