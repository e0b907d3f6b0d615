// SPDX-License-Identifier: MIT
#include "lobes/hemisphere_basis.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "math/gauss_legendre.h"
#include "math/legendre.h"

namespace shlight {
namespace {

/// Tikhonov's λ, against Gram eigenvalues of at most 1. Fits that converge keep coefficients below ten and lose nothing
/// above a relative error of about 1e-5; fits that do not would otherwise reach thousands.
constexpr double kRidge = 1e-7;

constexpr int triangle(int row, int column) {
    return row * (row + 1) / 2 + column;
}

/// ∫₀¹ P̄_l^m P̄_k^m dz · 2π for all l, k ≥ m, as lower triangles; exact with 64 Gauss points (degree ≤ 126).
std::array<std::vector<double>, kMaxOrder> gram_matrices() {
    std::array<std::vector<double>, kMaxOrder> gram;
    for (int m = 0; m < kMaxOrder; ++m) {
        gram[m].assign(triangle(kMaxOrder - m, 0), 0.0);
    }
    const GaussRule& rule = gauss_rule(kMaxGaussPoints);
    std::vector<double> values(kCosineMax);
    std::array<double, kMaxOrder> sines;
    for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const double z = rule.nodes[i];
        const double sine_squared = (1 - z) * (1 + z);
        powers(std::sqrt(sine_squared), kMaxOrder, sines.data());
        LegendreRows<double> legendre(z, sine_squared);
        for (int l = 0; l < kMaxOrder; ++l) {
            for (int m = 0; m <= l; ++m) {
                values[at(l, m)] = legendre[m] * sines[m];
            }
            if (l + 1 < kMaxOrder) {
                legendre.advance();
            }
        }
        const double weight = 2 * std::numbers::pi * rule.weights[i];
        for (int m = 0; m < kMaxOrder; ++m) {
            std::vector<double>& g = gram[m];
            for (int row = 0; row < kMaxOrder - m; ++row) {
                const double left = weight * values[at(m + row, m)];
                for (int column = 0; column <= row; ++column) {
                    g[triangle(row, column)] += left * values[at(m + column, m)];
                }
            }
        }
    }
    return gram;
}

void cholesky(std::vector<double>& a, int size) {
    for (int row = 0; row < size; ++row) {
        for (int column = 0; column <= row; ++column) {
            double sum = a[triangle(row, column)];
            for (int k = 0; k < column; ++k) {
                sum -= a[triangle(row, k)] * a[triangle(column, k)];
            }
            a[triangle(row, column)] = row == column ? std::sqrt(sum) : sum / a[triangle(column, column)];
        }
    }
}

}  // namespace

HemisphereBasis::HemisphereBasis() : rows_(gram_matrices()) {
    for (int m = 0; m < kMaxOrder; ++m) {
        const int size = kMaxOrder - m;
        std::vector<double>& a = rows_[m];
        for (int row = 0; row < size; ++row) {
            a[triangle(row, row)] += kRidge;
        }
        cholesky(a, size);
    }
}

const HemisphereBasis& HemisphereBasis::get() {
    static const HemisphereBasis basis;
    return basis;
}

void HemisphereBasis::reduce(std::span<double> moments) const {
    std::array<double, kMaxOrder> y;
    for (int m = 0; m < kMaxOrder; ++m) {
        const double* row = rows_[m].data();
        for (int i = 0; i < kMaxOrder - m; ++i) {
            double sum = moments[at(m + i, m)];
            for (int k = 0; k < i; ++k) {
                sum -= row[k] * y[k];
            }
            y[i] = sum / row[i];
            moments[at(m + i, m)] = y[i];
            row += i + 1;
        }
    }
}

void HemisphereBasis::solve(std::span<const double> reduced, int order, std::span<double> coefficients) const {
    // Each unknown is taken out of all equations above it as soon as it is known: along rows of the factor.
    std::array<double, kMaxOrder> rest;
    for (int m = 0; m < order; ++m) {
        for (int i = 0; i < order - m; ++i) {
            rest[i] = reduced[at(m + i, m)];
        }
        for (int i = order - m - 1; i >= 0; --i) {
            const double* row = &rows_[m][triangle(i, 0)];
            const double f = rest[i] / row[i];
            coefficients[at(m + i, m)] = f;
            for (int k = 0; k < i; ++k) {
                rest[k] -= row[k] * f;
            }
        }
    }
}

std::array<double, kMaxOrder> HemisphereBasis::squared_errors(std::span<const double> reduced,
                                                              double norm_squared) const {
    // min |F - Y f|² + λ|f|² = |F|² - |y|², and the fit's own error is that without the second term.
    std::array<double, kMaxOrder> errors{};
    std::array<double, kCosineMax> coefficients;
    double explained = 0;
    for (int order = 1; order <= kMaxOrder; ++order) {
        for (int m = 0; m < order; ++m) {
            const double y = reduced[at(order - 1, m)];
            explained += y * y;
        }
        solve(reduced, order, coefficients);
        double size = 0;
        for (int i = 0; i < cosine_count(order); ++i) {
            size += coefficients[i] * coefficients[i];
        }
        errors[order - 1] = std::max(0.0, norm_squared - explained - kRidge * size);
    }
    return errors;
}

}  // namespace shlight
