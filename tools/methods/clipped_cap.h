// SPDX-License-Identifier: MIT
//
// The coefficients of a cap above the horizon in scalars: the text that the kernels of core/src/regions take into
// lanes, and the oracle of their tests. docs/theory.md, 3, derives it. Eq. n is an equation of Zhou & Wei 2020,
// "Spherical Light Integration over Spherical Caps via Spherical Harmonics".
//
// The paper integrates 2n-1 zonal functions along the cap's boundary (Eq. 9 to 18) and takes them to harmonics by a
// matrix (Eq. 6 and 8). Here a turn of the sphere about the cap's axis, under which the cap's edge moves along itself,
// gives all integrals of a band by one recurrence in m, and the only zonal function is the one about that axis.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "math/legendre.h"
#include "shlight/cap.h"

namespace shlight {

/// Half angles of what the horizon keeps of a cap.
struct KeptAngles {
    double arc;          ///< φ_a: half of the horizon's arc inside the cap, half of the paper's φ_b - φ_a
    double edge;         ///< ψ_0: half of the cap's edge above the horizon, half of φ_1 - φ_0 (Eq. 19)
    double solid_angle;  ///< S_0 (Eq. 21)
};

/// The three cases of Eq. 21. Precondition: a half angle σ up to π/2, as a sphere's is.
inline KeptAngles kept_angles(const SphericalCap& cap) {
    const double pi = std::numbers::pi;
    const double z = cap.axis.z;  // cosθ
    const double one_minus_cos = cap.sine * cap.sine / (1 + cap.cosine);
    if (z >= cap.sine) {
        return {0, pi, 2 * pi * one_minus_cos};
    }
    if (z <= -cap.sine) {
        return {0, 0, 0};
    }
    // Arccosines, as in Eq. 19 and 21, lose half of the digits where cap and horizon all but touch. This length does
    // not.
    const double w = std::sqrt((cap.sine - z) * (cap.sine + z));
    const double edge = std::atan2(w, -cap.cosine * z);
    const double lens = 2 * std::atan2(w * z * one_minus_cos, w * w + cap.cosine * z * z);
    return {std::atan2(w, cap.cosine), edge, lens + 2 * edge * one_minus_cos};
}

/// P̄_l^m = K_l^m P_l^m (Eq. 2) at the angle with this cosine and sine, m = 0 … l, and 0 for m = l + 1.
inline std::vector<double> legendre_row(int l, double cosine, double sine) {
    LegendreRows<double> rows(cosine, sine * sine);
    while (rows.band() < l) {
        rows.advance();
    }
    std::vector<double> row;
    for (int m = 0; m <= l; ++m) {
        row.push_back(rows[m] * std::pow(sine, m));
    }
    row.push_back(0);
    return row;
}

/// T_l = ∫ P_l(ω·L) dω over the kept cap. Stokes' theorem, as in Eq. 10 and 11, but on the Laplacian of P_l: along the
/// cap's edge ω·L is constant, along the horizon the addition theorem separates ω and L.
inline double zonal_integral(const SphericalCap& cap, const KeptAngles& kept, int l, const std::vector<double>& at_axis,
                             const std::vector<double>& on_horizon) {
    // P'_k = (2k-1) P_{k-1} + P'_{k-2}, as for Eq. 18.
    std::array<double, kMaxOrder + 1> p{1, cap.cosine}, slope{0, 1};
    for (int k = 2; k <= l; ++k) {
        p[k] = ((2 * k - 1) * cap.cosine * p[k - 1] - (k - 1) * p[k - 2]) / k;
        slope[k] = (2 * k - 1) * p[k - 1] + slope[k - 2];
    }
    double along_horizon = 0;
    for (int m = 0; m <= l; ++m) {
        const double normal_slope = std::sqrt((l - m) * (l + m + 1.0)) * on_horizon[m + 1];  // dP̄_l^m/dz at z = 0
        along_horizon += at_axis[m] * normal_slope * (m == 0 ? 2 * kept.arc : 4 * std::sin(m * kept.arc) / m);
    }
    const double along_edge = 2 * kept.edge * cap.sine * cap.sine * slope[l];
    return (along_edge + 4 * std::numbers::pi / (2 * l + 1) * along_horizon) / (l * (l + 1));
}

/// X_m = ∫ P̄_l^m cos mφ dω over the kept cap, m = 0 … l, about the axis L = (sinθ, 0, cosθ) of Eq. 12; l ≥ 1.
inline std::vector<double> clipped_cap_band(const SphericalCap& cap, const KeptAngles& kept, int l) {
    const double cosine = cap.axis.z;
    const double sine = std::hypot(cap.axis.x, cap.axis.y);
    const std::vector<double> n = legendre_row(l, cosine, sine);
    const std::vector<double> on_horizon = legendre_row(l, 0, 1);
    std::vector<double> x(n.size());
    if (kept.arc > 0) {
        // Only the horizon's arc gives the turn about L a right side: for m = 1 … l
        //   -a_{m-1} X_{m-1} + m cosθ X_m - a_m X_{m+1} = R_m = -sinθ P̄_l^m(0) ∫ sin mφ sinφ dφ,   |φ| ≤ φ_a.
        const auto a = [&](int m) { return sine / 2 * std::sqrt((l - m) * (l + m + 1.0)); };
        std::vector<double> r(n.size()), above(n.size());
        for (int m = l; m > 0; --m) {
            const double lower = m == 1 ? kept.arc : std::sin((m - 1) * kept.arc) / (m - 1);
            r[m] = -sine * on_horizon[m] * (lower - std::sin((m + 1) * kept.arc) / (m + 1));
            above[m - 1] = above[m] + n[m] * r[m];
        }
        // N_m = P̄_l^m(cosθ) solves it without right side, and so does Q. Their Casoratian W is the same for every m,
        // so Green's function is X_m = (N_m Σ_{k≤m} Q_k R_k + Q_m Σ_{k>m} N_k R_k) / W.
        std::vector<double> q{-n[1], n[0]};
        for (int m = 1; m < l; ++m) {
            q.push_back((m * cosine * q[m] - a(m - 1) * q[m - 1]) / a(m));
        }
        const double w = a(0) * (n[0] * n[0] + n[1] * n[1]);
        double below = 0;
        for (int m = 0; m <= l; ++m) {
            below += q[m] * r[m];
            x[m] = (n[m] * below + q[m] * above[m]) / w;
        }
    }
    // The equations leave any multiple of N open. Σ (2 - δ_m0) N_m X_m is (2l+1)/4π T_l.
    double dot = n[0] * x[0];
    for (int m = 1; m <= l; ++m) {
        dot += 2 * n[m] * x[m];
    }
    const double missing = zonal_integral(cap, kept, l, n, on_horizon) - 4 * std::numbers::pi / (2 * l + 1) * dot;
    for (int m = 0; m <= l; ++m) {
        x[m] += missing * n[m];
    }
    return x;
}

/// L_l^m (Eq. 4) of unit radiance, order² numbers. Turning L = (sinθ, 0, cosθ) to the axis' azimuth φ_L multiplies
/// X_m by cos mφ_L and sin mφ_L, and Eq. 2 has √2 for m ≠ 0.
inline std::vector<double> clipped_cap_coefficients(const SphericalCap& cap, int order) {
    const KeptAngles kept = kept_angles(cap);
    const double azimuth = std::atan2(cap.axis.y, cap.axis.x);
    std::vector<double> coefficients(static_cast<std::size_t>(coefficient_count(order)));
    coefficients[0] = kept.solid_angle * std::numbers::inv_sqrtpi / 2;
    for (int l = 1; l < order && kept.solid_angle > 0; ++l) {
        const std::vector<double> x = clipped_cap_band(cap, kept, l);
        coefficients[coefficient_index(l, 0)] = x[0];
        for (int m = 1; m <= l; ++m) {
            coefficients[coefficient_index(l, m)] = std::numbers::sqrt2 * x[m] * std::cos(m * azimuth);
            coefficients[coefficient_index(l, -m)] = std::numbers::sqrt2 * x[m] * std::sin(m * azimuth);
        }
    }
    return coefficients;
}

}  // namespace shlight
