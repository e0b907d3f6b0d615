// SPDX-License-Identifier: MIT
//
// A second derivation of the clipped cap. Turning the sphere about the cap's axis gives, for each band, l equations for
// its l + 1 cosine terms. Here they are solved as they stand, by factorization of the matrix with five diagonals A Aᵀ,
// while the library runs Green's function as a recurrence.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "clipped_cap.h"
#include "random_input.h"
#include "shlight/cap.h"

namespace shlight {
namespace {

constexpr double kPi = std::numbers::pi;

/// P̄_l^m without Condon–Shortley phase.
double legendre(int l, int m, double tilt) {
    return (m % 2 == 0 ? 1 : -1) * std::sph_legendre(static_cast<unsigned>(l), static_cast<unsigned>(m), tilt);
}

/// ∫ P_l(ω·L) dω over the kept region by Simpson's rule on rings about the axis; α = α_0 + (σ - α_0) u² takes the
/// square root out of the first ring that the horizon cuts.
double zonal_by_rings(int l, double tilt, double half) {
    const auto polynomial = [l](double alpha) { return std::legendre(static_cast<unsigned>(l), std::cos(alpha)); };
    const auto integral = [](double end, const auto& f) {
        const int steps = 4000;
        double sum = f(0.0) + f(end);
        for (int i = 1; i < steps; ++i) {
            sum += (i % 2 == 0 ? 2 : 4) * f(end * i / steps);
        }
        return sum * end / steps / 3;
    };
    const double first_cut = std::abs(kPi / 2 - tilt);
    const double cut = integral(1.0, [&](double u) {
        const double alpha = first_cut + (half - first_cut) * u * u;
        const double kept = u == 0 ? (tilt < kPi / 2 ? kPi : 0)
                                   : std::acos(std::clamp(-1 / (std::tan(alpha) * std::tan(tilt)), -1.0, 1.0));
        return 2 * kept * polynomial(alpha) * std::sin(alpha) * 2 * (half - first_cut) * u;
    });
    const double whole = integral(tilt < kPi / 2 ? first_cut : 0,
                                  [&](double alpha) { return 2 * kPi * polynomial(alpha) * std::sin(alpha); });
    return cut + whole;
}

/// Solves the symmetric, positive definite system with five diagonals; diagonals[d][i] is element (i, i + d).
std::vector<double> solve_five_diagonals(std::array<std::vector<double>, 3> diagonals, std::vector<double> x) {
    const std::size_t n = x.size();
    for (std::size_t k = 0; k < n; ++k) {
        for (std::size_t d = 1; d <= 2 && k + d < n; ++d) {
            const double factor = diagonals[d][k] / diagonals[0][k];
            for (std::size_t e = d; e <= 2; ++e) {
                diagonals[e - d][k + d] -= factor * diagonals[e][k];
            }
            x[k + d] -= factor * x[k];
        }
    }
    for (std::size_t k = n; k-- > 0;) {
        for (std::size_t d = 1; d <= 2 && k + d < n; ++d) {
            x[k] -= diagonals[d][k] * x[k + d];
        }
        x[k] /= diagonals[0][k];
    }
    return x;
}

/// The orthonormal cosine terms of band l: Aᵀ (A Aᵀ)⁻¹ R + T_l N.
std::vector<double> solved_band(int l, double tilt, double half) {
    const auto size = static_cast<std::size_t>(l);
    const double arc = std::acos(std::cos(half) / std::sin(tilt));
    std::vector<std::array<double, 3>> rows(size);  // row of degree m: columns m-1, m, m+1
    std::vector<double> right(size);
    for (int m = 1; m <= l; ++m) {
        const auto coupling = [&](int k) { return 0.5 * std::sin(tilt) * std::sqrt((l - k) * (l + k + 1)); };
        const double to_zero = m == 1 ? std::numbers::sqrt2 : 1;
        const double low = m == 1 ? arc : std::sin((m - 1) * arc) / (m - 1);
        const auto i = static_cast<std::size_t>(m - 1);
        rows[i] = {-to_zero * coupling(m - 1), m * std::cos(tilt), -coupling(m)};
        right[i] =
            -std::numbers::sqrt2 * std::sin(tilt) * legendre(l, m, kPi / 2) * (low - std::sin((m + 1) * arc) / (m + 1));
    }
    std::array<std::vector<double>, 3> diagonals;
    for (std::size_t d = 0; d <= 2; ++d) {
        diagonals[d].assign(size, 0.0);
        for (std::size_t i = 0; i + d < size; ++i) {
            for (std::size_t j = 0; j + d <= 2; ++j) {
                const bool past_end = i + d + j == size + 1;  // there is no degree l + 1
                diagonals[d][i] += past_end ? 0 : rows[i][j + d] * rows[i + d][j];
            }
        }
    }
    const std::vector<double> y = solve_five_diagonals(diagonals, right);
    std::vector<double> terms(size + 2);
    for (std::size_t i = 0; i < size; ++i) {
        for (std::size_t j = 0; j <= 2; ++j) {
            terms[i + j] += rows[i][j] * y[i];
        }
    }
    const double zonal = zonal_by_rings(l, tilt, half);
    for (int m = 0; m <= l; ++m) {
        terms[static_cast<std::size_t>(m)] += zonal * (m == 0 ? 1 : std::numbers::sqrt2) * legendre(l, m, tilt);
    }
    return terms;
}

TEST(CapSolve, AgreesWithFactorization) {
    testing::RandomInput random(20);
    const int order = 24;
    std::vector<double> coefficients(coefficient_count(order));
    for (int i = 0; i < 60; ++i) {
        const double half = random.uniform(0.3, 1.5);
        const double depth = half * random.uniform(0.2, 0.8);
        const double tilt = kPi / 2 + (i % 2 == 0 ? depth : -depth);
        const Vec3d axis(std::sin(tilt), 0, std::cos(tilt));
        cap_coefficients<double>({&axis, 1}, {&half, 1}, order, true, coefficients);
        const std::vector<double> transcribed = clipped_cap_coefficients(cap_about_axis(axis, half), order);
        for (int l = 1; l < order; ++l) {
            const std::vector<double> expected = solved_band(l, tilt, half);
            for (int m = 0; m <= l; ++m) {
                const double computed = coefficients[coefficient_index(l, m)];
                EXPECT_NEAR(computed, expected[static_cast<std::size_t>(m)], 1e-11 * coefficients[0])
                    << "half angle " << half << ", tilt " << tilt << ", l " << l << ", m " << m;
                EXPECT_NEAR(transcribed[coefficient_index(l, m)], expected[static_cast<std::size_t>(m)],
                            1e-11 * coefficients[0]);
                EXPECT_LE(m == 0 ? 0 : std::abs(coefficients[coefficient_index(l, -m)]), 1e-300);
            }
        }
    }
}

TEST(CapSolve, KernelsAreTheTranscription) {
    // Hidden, whole and clipped caps, slivers among them. The transcription's ∫ sin²φ dφ cancels to ε φ_a, which is
    // some ε / σ of the whole cap's L_00.
    testing::RandomInput random(21);
    const int order = 32;
    std::vector<double> coefficients(coefficient_count(order));
    for (int i = 0; i < 3000; ++i) {
        const double half = random.log_uniform(0.01, 1.5);
        const double reach = i % 3 == 0 ? kPi / 2 : half;
        const SphericalCap cap = cap_about_axis(random.at_tilt(kPi / 2 + reach * random.uniform(-1, 1)), half);
        cap_coefficients<double>({&cap, 1}, order, true, coefficients);
        const std::vector<double> transcribed = clipped_cap_coefficients(cap, order);
        double largest = 0;
        for (std::size_t k = 0; k < transcribed.size(); ++k) {
            const double error = std::abs(coefficients[k] - transcribed[k]);
            largest = std::isnan(error) ? 1e300 : std::max(largest, error);
        }
        EXPECT_LE(largest, 1e-12 * std::sqrt(kPi) * (1 - cap.cosine))
            << "half angle " << half << ", tilt " << std::acos(cap.axis.z);
    }
}

}  // namespace
}  // namespace shlight
