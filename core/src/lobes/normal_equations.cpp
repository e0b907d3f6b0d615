// SPDX-License-Identifier: MIT
#include "lobes/normal_equations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "math/legendre.h"

namespace shlight {
namespace {

/// Tikhonov's λ; eigenvalues of the Gram matrix are at most 1. Fits that converge keep coefficients below ten and a
/// relative error of about 1e-5. Without λ the coefficients of others would reach thousands.
constexpr double kRidge = 1e-7;

constexpr int triangle(int row, int column) {
    return row * (row + 1) / 2 + column;
}

}  // namespace

HeightBasis::HeightBasis(std::span<const double> heights, int order)
    : order_(order), heights_(heights.size()), values_(static_cast<std::size_t>(cosine_count(order)) * heights.size()) {
    std::array<double, kMaxOrder> sines;
    for (std::size_t i = 0; i < heights_; ++i) {
        const double sine_squared = std::max(0.0, (1 - heights[i]) * (1 + heights[i]));
        powers(std::sqrt(sine_squared), order, sines.data());
        LegendreRows<double> legendre(heights[i], sine_squared);
        for (int l = 0; l < order; ++l) {
            for (int m = 0; m <= l; ++m) {
                values_[at(l, m) * heights_ + i] = legendre[m] * sines[m];
            }
            if (l + 1 < order) {
                legendre.advance();
            }
        }
    }
}

NormalEquations::NormalEquations(const HeightBasis& basis, std::span<const double> weights)
    : order_(basis.order()), rows_(static_cast<std::size_t>(basis.order())) {
    std::vector<double> weighted(weights.size());
    for (int m = 0; m < order_; ++m) {
        std::vector<double>& factor = rows_[m];
        factor.resize(static_cast<std::size_t>(triangle(order_ - m, 0)));
        for (int row = 0; row < order_ - m; ++row) {
            const auto values = basis.values(m + row, m);
            std::transform(values.begin(), values.end(), weights.begin(), weighted.begin(),
                           [](double value, double weight) { return 2 * std::numbers::pi * weight * value; });
            const double* pivot_row = &factor[triangle(row, 0)];
            for (int column = 0; column <= row; ++column) {
                const double* other = &factor[triangle(column, 0)];
                double sum = std::inner_product(weighted.begin(), weighted.end(), basis.values(m + column, m).begin(),
                                                row == column ? kRidge : 0.0);
                for (int k = 0; k < column; ++k) {
                    sum -= pivot_row[k] * other[k];
                }
                factor[triangle(row, column)] = row == column ? std::sqrt(sum) : sum / other[column];
            }
        }
    }
}

void NormalEquations::reduce(std::span<double> moments) const {
    std::array<double, kMaxOrder> y;
    for (int m = 0; m < order_; ++m) {
        const double* row = rows_[m].data();
        for (int i = 0; i < order_ - m; ++i) {
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

void NormalEquations::solve(std::span<const double> reduced, int order, std::span<double> coefficients) const {
    // A solved unknown is subtracted from all equations above it, so that rows of the factor are read in order.
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

double NormalEquations::squared_error(std::span<const double> reduced, int order, double norm_squared) const {
    // min |F - Y f|² + λ|f|² = |F|² - |y|²; the fit's error is this minimum without its second term.
    std::array<double, kCosineMax> coefficients;
    solve(reduced, order, coefficients);
    const auto count = static_cast<std::size_t>(cosine_count(order));
    const auto square = [](std::span<const double> v) {
        return std::inner_product(v.begin(), v.end(), v.begin(), 0.0);
    };
    return std::max(
        0.0, norm_squared - square(reduced.first(count)) - kRidge * square(std::span(coefficients).first(count)));
}

}  // namespace shlight
