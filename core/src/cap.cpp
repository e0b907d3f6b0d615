// SPDX-License-Identifier: MIT
#include "shlight/cap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "band_system.h"
#include "checks.h"
#include "exact_sums.h"
#include "legendre.h"

namespace shlight {
namespace {

/// Axis-dependent half of a cap. The few scalars of a light are worked out in double for either T: near contact and
/// tangency they amplify rounding, and their share of the time is small.
struct Axis {
    double length, height, cos_tilt, sin_tilt, cos_azimuth, sin_azimuth;

    explicit Axis(const Vec3d& v) {
        const double radial = std::hypot(v.x, v.y);
        length = std::hypot(radial, v.z);
        height = v.z;
        cos_tilt = v.z / length;
        sin_tilt = radial / length;
        cos_azimuth = radial > 0 ? v.x / radial : 1.0;
        sin_azimuth = radial > 0 ? v.y / radial : 0.0;
    }
};

void check_sphere(const Vec3d& center, double radius, double epsilon) {
    check_finite("centers", center);
    if (!(std::isfinite(radius) && radius > 0)) {
        reject("radii must be positive and finite");
    }
    // Contact within the rounding of the inputs is contact.
    if (difference_of_squares({center.x, center.y, center.z}, radius) < -4 * epsilon * radius * radius) {
        reject("radii: the shading point lies inside a sphere (|center| < radius)");
    }
}

void check_cap(const Vec3d& axis, double half_angle) {
    check_finite("axes", axis);
    if (axis == Vec3d(0)) {
        reject("axes contains a zero vector");
    }
    if (!(half_angle > 0 && half_angle <= std::numbers::pi * (1 + 1e-7))) {
        reject("half_angles must lie in (0, π]");
    }
}

template <class T>
Cap<T> make_cap(const Axis& axis, double cos_half, double sin_half, double crossing_squared, bool complement) {
    const auto r = [](double x) { return static_cast<T>(x); };
    return {r(axis.cos_tilt),
            r(axis.sin_tilt),
            r(axis.cos_azimuth),
            r(axis.sin_azimuth),
            r(cos_half),
            r(sin_half),
            r(std::sqrt(std::max(0.0, crossing_squared))),
            complement};
}

/// The zonal integrals λ_l of an unclipped cap, ∫ P_l(ω·L) dω (Funk–Hecke).
/// λ_l = 2π sin²σ P_l'(cosσ) / (l(l+1)) is 2π (P_{l-1} - P_{l+1}) / (2l+1) without its cancellation;
/// λ_0 = 2π (1 - cosσ). For small caps P_l falls from 1 by l(l+1)/2 · (1 - cosσ): the recurrence runs on the
/// differences P_l - P_{l-1} and on 1 - cosσ = sin²σ / (1 + cosσ), because a rounded cosσ would be amplified by l².
template <class T>
class ZonalIntegrals {
  public:
    ZonalIntegrals(T cos_half, T sin_half) : sin2_(sin_half * sin_half), one_minus_cos_(sin2_ / (1 + cos_half)) {}

    T band_zero() const { return 2 * std::numbers::pi_v<T> * one_minus_cos_; }
    /// sin²σ P_l'(cosσ) for l = 1, 2, 3 … in turn.
    T next_edge() {
        ++l_;
        const T derivative = derivative_before_ + static_cast<T>(2 * l_ - 1) * p_;  // P'_l = P'_{l-2} + (2l-1) P_{l-1}
        derivative_before_ = derivative_;
        derivative_ = derivative;
        rise_ =
            (static_cast<T>(l_ - 1) * rise_ - static_cast<T>(2 * l_ - 1) * one_minus_cos_ * p_) / static_cast<T>(l_);
        p_ += rise_;
        return sin2_ * derivative;
    }

  private:
    T sin2_, one_minus_cos_;
    int l_ = 0;
    T p_ = 1, rise_ = 0;                        // P_l, P_l - P_{l-1}
    T derivative_before_ = 0, derivative_ = 0;  // P'_{l-1}, P'_l
};

/// Spreads the cosine terms of one band in the frame where the light has azimuth 0 over ±m.
template <class T>
void turn_band(int l, const T* cosine_terms, const T* cos_m, const T* sin_m, T* coefficients) {
    T* band = coefficients + coefficient_index(l, 0);
    band[0] = cosine_terms[0];
    for (int m = 1; m <= l; ++m) {
        const T value = std::numbers::sqrt2_v<T> * cosine_terms[m];
        band[m] = value * cos_m[m];
        band[-m] = value * sin_m[m];
    }
}

template <class T>
void whole_cap(const Cap<T>& cap, int order, T* coefficients) {
    std::array<T, kMaxOrder> cos_m;
    std::array<T, kMaxOrder> sin_m;
    complex_powers(cap.sin_tilt * cap.cos_azimuth, cap.sin_tilt * cap.sin_azimuth, order, cos_m.data(), sin_m.data());
    LegendreRows<T> legendre(cap.cos_tilt, cap.sin_tilt * cap.sin_tilt);
    ZonalIntegrals<T> zonal(cap.cos_half, cap.sin_half);
    coefficients[0] = zonal.band_zero() * legendre[0];
    std::array<T, kMaxOrder> band;
    for (int l = 1; l < order; ++l) {
        legendre.advance();
        const T lambda = 2 * std::numbers::pi_v<T> * zonal.next_edge() / static_cast<T>(l * (l + 1));
        for (int m = 0; m <= l; ++m) {
            band[m] = lambda * legendre[m];
        }
        turn_band(l, band.data(), cos_m.data(), sin_m.data(), coefficients);
    }
}

/// Where the cap's edge meets the horizon.
template <class T>
struct HorizonArc {
    T half_arc;     ///< φ_a: the horizon is covered for |φ| ≤ φ_a
    T half_edge;    ///< ψ_0: half of the cap's edge above the horizon, as an angle about its axis
    T solid_angle;  ///< Ω of the kept region
    std::array<T, kMaxOrder + 1> sine_over_m;  ///< sin(m φ_a) / m, φ_a for m = 0
    std::array<T, kMaxOrder> moment;           ///< I_m = ∫ sin mφ sin φ dφ over the arc

    HorizonArc(const Cap<T>& cap, int order) {
        const T w = cap.crossing;
        const T one_minus_cos = cap.sin_half * cap.sin_half / (1 + cap.cos_half);
        half_arc = std::atan2(w, cap.cos_half);
        half_edge = std::atan2(w, -cap.cos_half * cap.cos_tilt);
        // Both terms are of the size of the region, for small caps too: 1 - cosσ never appears as a difference.
        solid_angle =
            2 * std::atan2(w * cap.cos_tilt * one_minus_cos, w * w + cap.cos_half * cap.cos_tilt * cap.cos_tilt) +
            2 * half_edge * one_minus_cos;
        fill_sines(w, cap.cos_half, order);
        fill_moments(order);
    }

  private:
    void fill_sines(T w, T cos_half, int order) {
        const T chord = std::hypot(w, cos_half);
        std::array<T, kMaxOrder + 1> unused;
        complex_powers(cos_half / chord, w / chord, order + 1, unused.data(), sine_over_m.data());
        sine_over_m[0] = half_arc;
        for (int m = 1; m <= order; ++m) {
            sine_over_m[m] /= static_cast<T>(m);
        }
    }

    void fill_moments(int order) {
        moment[0] = 0;
        for (int m = 1; m < order; ++m) {
            moment[m] =
                static_cast<T>(m + 1) * half_arc < T(0.6) ? moment_series(m) : sine_over_m[m - 1] - sine_over_m[m + 1];
        }
    }

    /// The power series of sin((m-1)φ)/(m-1) - sin((m+1)φ)/(m+1), whose two terms agree to φ³ for short arcs.
    T moment_series(int m) const {
        const T low = static_cast<T>((m - 1) * (m - 1));
        const T high = static_cast<T>((m + 1) * (m + 1));
        T term = half_arc, low_power = 1, high_power = 1, sum = 0;
        for (int j = 1; j < 8; ++j) {
            term *= -half_arc * half_arc / static_cast<T>(2 * j * (2 * j + 1));
            low_power *= low;
            high_power *= high;
            sum += term * (low_power - high_power);
        }
        return sum;
    }
};

/// T_l = ∫ P_l(ω·L) over the kept region: Stokes on the Laplacian, the cap's edge plus the horizon arc
/// (on which P_l(ω·L) is expanded by the addition theorem; only odd l - m have a normal derivative there).
template <class T>
T clipped_zonal_integral(int l, T edge, const HorizonArc<T>& arc, const T* null) {
    const T* dz = &LegendreConstants<T>::get().dz_at_horizon[at(l, 0)];
    T horizon = 0;
    for (int m = (l + 1) % 2; m <= l; m += 2) {
        horizon += (m == 0 ? T(2) : T(4)) * dz[m] * null[m] * arc.sine_over_m[m];
    }
    const T four_pi_over = 4 * std::numbers::pi_v<T> / static_cast<T>(2 * l + 1);
    return (2 * arc.half_edge * edge + four_pi_over * horizon) / static_cast<T>(l * (l + 1));
}

template <class T>
void clipped_cap(const Cap<T>& cap, int order, T* coefficients) {
    const HorizonArc<T> arc(cap, order);
    const auto& constants = LegendreConstants<T>::get();
    std::array<T, kMaxOrder> cos_m, sin_m, sin_tilt_powers;
    complex_powers(cap.cos_azimuth, cap.sin_azimuth, order, cos_m.data(), sin_m.data());
    powers(cap.sin_tilt, order, sin_tilt_powers.data());
    LegendreRows<T> legendre(cap.cos_tilt, cap.sin_tilt * cap.sin_tilt);
    ZonalIntegrals<T> zonal(cap.cos_half, cap.sin_half);
    coefficients[0] = arc.solid_angle * legendre[0];
    std::array<T, kMaxOrder> right, band, null;
    for (int l = 1; l < order; ++l) {
        legendre.advance();
        const T* at_horizon = &constants.at_horizon[at(l, 0)];
        for (int m = 0; m <= l; ++m) {
            null[m] = legendre[m] * sin_tilt_powers[m];
            right[m] = -cap.sin_tilt * at_horizon[m] * arc.moment[m];
        }
        BandSystem<T>(l, cap.cos_tilt, cap.sin_tilt, legendre.row()).solve(right.data(), band.data());
        const T zonal_integral = clipped_zonal_integral(l, zonal.next_edge(), arc, null.data());
        set_null_component(l, null.data(), zonal_integral, band.data());
        turn_band(l, band.data(), cos_m.data(), sin_m.data(), coefficients);
    }
}

/// Coefficients of the region that a complement is taken from: the upper hemisphere or the whole sphere.
template <class T>
void subtract_from_everything(int order, bool clip, T* coefficients) {
    const int count = coefficient_count(order);
    for (int i = 0; i < count; ++i) {
        coefficients[i] = -coefficients[i];
    }
    if (!clip) {
        coefficients[0] += std::sqrt(4 * std::numbers::pi_v<T>);
        return;
    }
    std::array<T, static_cast<std::size_t>(coefficient_count(kMaxOrder))> hemisphere;
    whole_cap(Cap<T>{1, 0, 1, 0, 0, 1, 0, false}, order, hemisphere.data());
    for (int l = 0; l < order; ++l) {
        const int i = coefficient_index(l, 0);
        coefficients[i] += hemisphere[i];
    }
}

}  // namespace

template <class T>
Cap<T> Cap<T>::of_sphere(const Vec3<T>& center, T radius) {
    const Vec3d c(center);
    const double r = radius;
    const Axis axis(c);
    // |c|² - r² and r² - c_z² by exact products: near contact and tangency they are small differences of the inputs.
    const double tangent_squared = std::max(0.0, difference_of_squares({c.x, c.y, c.z}, r));
    const double sin_half = std::min(1.0, r / axis.length);
    const double crossing = (r - c.z) * (r + c.z) / (axis.length * axis.length);
    return make_cap<T>(axis, std::sqrt(tangent_squared) / axis.length, sin_half, crossing, false);
}

template <class T>
Cap<T> Cap<T>::of_facing_disk(const Vec3<T>& center, T radius) {
    const Axis axis{Vec3d(center)};
    const double slant = std::hypot(axis.length, static_cast<double>(radius));
    const double sin_half = radius / slant;
    const double crossing = (sin_half - axis.cos_tilt) * (sin_half + axis.cos_tilt);
    return make_cap<T>(axis, axis.length / slant, sin_half, crossing, false);
}

template <class T>
Cap<T> Cap<T>::about_axis(const Vec3<T>& axis_vector, T half_angle) {
    const double half = std::min(static_cast<double>(half_angle), std::numbers::pi);
    const bool complement = half > std::numbers::pi / 2;
    const Vec3d v(axis_vector);
    const Axis axis(complement ? -v : v);
    const double sin_half = std::sin(half);
    const double crossing = (sin_half - axis.cos_tilt) * (sin_half + axis.cos_tilt);
    return make_cap<T>(axis, std::abs(std::cos(half)), sin_half, crossing, complement);
}

template <class T>
void cap_coefficients(const Cap<T>& cap, int order, bool clip, T* coefficients) {
    if (!clip || (cap.crossing <= 0 && cap.cos_tilt > 0)) {
        whole_cap(cap, order, coefficients);
    } else if (cap.crossing <= 0) {
        std::fill_n(coefficients, coefficient_count(order), T(0));
    } else {
        clipped_cap(cap, order, coefficients);
    }
    if (cap.complement) {
        subtract_from_everything(order, clip, coefficients);
    }
}

template <class T>
void sphere_coefficients(std::span<const Vec3<T>> centers, std::span<const T> radii, int order, bool clip,
                         std::span<T> coefficients) {
    check_order(order);
    check_size("radii", radii.size(), centers.size());
    const auto row = static_cast<std::size_t>(coefficient_count(order));
    check_size("coefficients", coefficients.size(), centers.size() * row);
    for (std::size_t i = 0; i < centers.size(); ++i) {
        check_sphere(Vec3d(centers[i]), radii[i], std::numeric_limits<T>::epsilon());
        cap_coefficients(Cap<T>::of_sphere(centers[i], radii[i]), order, clip, coefficients.data() + i * row);
    }
}

template <class T>
void cap_coefficients(std::span<const Vec3<T>> axes, std::span<const T> half_angles, int order, bool clip,
                      std::span<T> coefficients) {
    check_order(order);
    check_size("half_angles", half_angles.size(), axes.size());
    const auto row = static_cast<std::size_t>(coefficient_count(order));
    check_size("coefficients", coefficients.size(), axes.size() * row);
    for (std::size_t i = 0; i < axes.size(); ++i) {
        check_cap(Vec3d(axes[i]), half_angles[i]);
        cap_coefficients(Cap<T>::about_axis(axes[i], half_angles[i]), order, clip, coefficients.data() + i * row);
    }
}

template struct Cap<float>;
template struct Cap<double>;
template void cap_coefficients(const Cap<float>&, int, bool, float*);
template void cap_coefficients(const Cap<double>&, int, bool, double*);
template void sphere_coefficients(std::span<const Vec3<float>>, std::span<const float>, int, bool, std::span<float>);
template void sphere_coefficients(std::span<const Vec3<double>>, std::span<const double>, int, bool, std::span<double>);
template void cap_coefficients(std::span<const Vec3<float>>, std::span<const float>, int, bool, std::span<float>);
template void cap_coefficients(std::span<const Vec3<double>>, std::span<const double>, int, bool, std::span<double>);

}  // namespace shlight
