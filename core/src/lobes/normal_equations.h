// SPDX-License-Identifier: MIT
//
// The normal equations of least-squares fits by cosine terms over a zone z_0 ≤ z ≤ 1 of the sphere.
//
// cos mφ separates the degrees, so each m is a fit of its own in the functions P̄_l^m(z), l = m …, whose Gram matrix
// does not depend on what is fitted. Harmonics of high order are nearly dependent on half a sphere; Tikhonov's term λ
// keeps the coefficients of the order of the function (they multiply light coefficients with rounding errors). Leading
// blocks of a Cholesky factor are the factors of the leading blocks: one factor serves all orders.
#pragma once

#include <span>
#include <vector>

#include "shlight/types.h"

namespace shlight {

/// Values of P̄_l^m, without the factor √2 of m > 0, at a list of heights z.
class HeightBasis {
  public:
    HeightBasis(std::span<const double> heights, int order);

    int order() const { return order_; }
    std::span<const double> values(int l, int m) const {
        return std::span(values_).subspan(static_cast<std::size_t>(cosine_index(l, m)) * heights_, heights_);
    }

  private:
    int order_;
    std::size_t heights_;
    std::vector<double> values_;  // cosine_count(order) × heights
};

/// The fits of all orders up to that of a basis. Cosine terms and their moments are in cosine_index layout.
class NormalEquations {
  public:
    /// weights: quadrature weights of the heights, ∫ dz = Σ weights.
    NormalEquations(const HeightBasis& basis, std::span<const double> weights);

    /// y = L⁻¹ b, in place, for moments b = ∫ f Y_lm dω. Its entries serve every order.
    void reduce(std::span<double> moments) const;
    /// The fit of an order from y: L⁻ᵀ y over the bands below the order; cosine_count(order) values.
    void solve(std::span<const double> reduced, int order, std::span<double> coefficients) const;
    /// ∫ (fit - f)² dω of that fit, given ∫ f² dω.
    double squared_error(std::span<const double> reduced, int order, double norm_squared) const;

  private:
    int order_;
    std::vector<std::vector<double>> rows_;  // per m the lower triangle of L, row by row
};

}  // namespace shlight
