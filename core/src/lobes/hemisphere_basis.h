// SPDX-License-Identifier: MIT
//
// The normal equations of a least-squares fit over the upper hemisphere.
//
// cos mφ separates the degrees, so each m is a fit of its own in the functions P̄_l^m(z), l = m … 63, 0 ≤ z ≤ 1, whose
// Gram matrix does not depend on what is fitted. Harmonics of high order are nearly dependent on half a sphere;
// Tikhonov's term λ keeps the coefficients of the order of the function (they multiply light coefficients with rounding
// errors). Leading blocks of the Cholesky factor are the factors of the lower orders: one factor serves all.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "shlight/types.h"

namespace shlight {

class HemisphereBasis {
  public:
    static const HemisphereBasis& get();

    /// y = L⁻¹ b, in place, for moments b of order 64 (cosine_index layout). Its entries serve every order.
    void reduce(std::span<double> moments) const;
    /// The fit of an order from y: f = L⁻ᵀ y over the bands below the order; cosine_count(order) values.
    void solve(std::span<const double> reduced, int order, std::span<double> coefficients) const;
    /// L2 errors² of the fits of the orders 1 … 64, given ∫ (f·cos)² dω.
    std::array<double, kMaxOrder> squared_errors(std::span<const double> reduced, double norm_squared) const;

  private:
    HemisphereBasis();

    std::array<std::vector<double>, kMaxOrder> rows_;  // per m the lower triangle of L, row by row
};

}  // namespace shlight
