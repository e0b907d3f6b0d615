// SPDX-License-Identifier: MIT
//
// Sums of products with one rounding in effect, for differences that decide how a light touches the shading point.
#pragma once

#include <array>
#include <cmath>

namespace shlight {

/// A sum of products in doubled precision (Ogita, Rump & Oishi 2005, "Accurate sum and dot product", Dot2).
class CompensatedSum {
  public:
    void add_product(double a, double b) {
        const double product = a * b;
        const double product_error = std::fma(a, b, -product);
        const double sum = high_ + product;
        const double rest = sum - high_;
        low_ += ((high_ - (sum - rest)) + (product - rest)) + product_error;
        high_ = sum;
    }
    double value() const { return high_ + low_; }

  private:
    double high_ = 0, low_ = 0;
};

/// |v|² - r² without the cancellation of |v| ≈ r: what plain arithmetic leaves to it is wrong by some 1e-15 of itself.
inline double difference_of_squares(const std::array<double, 3>& v, double r) {
    const double minuend = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    const double subtrahend = r * r;
    if (minuend > 1.25 * subtrahend) {
        return minuend - subtrahend;
    }
    CompensatedSum sum;
    for (const double x : v) {
        sum.add_product(x, x);
    }
    sum.add_product(-r, r);
    return sum.value();
}

}  // namespace shlight
