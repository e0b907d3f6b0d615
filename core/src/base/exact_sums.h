// SPDX-License-Identifier: MIT
//
// Sums of products that are exact but for about one rounding, for differences that decide how a light touches the
// shading point.
#pragma once

#include <array>
#include <cmath>

#include "shlight/types.h"

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

/// a b - c d to within two roundings, even if the terms cancel (Kahan).
inline double difference_of_products(double a, double b, double c, double d) {
    const double product = c * d;
    return std::fma(a, b, -product) - std::fma(c, d, -product);
}

/// a·(b×c) to about one rounding, even if the three vectors are nearly coplanar.
inline double triple_product(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    CompensatedSum sum;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        const int k = (i + 2) % 3;
        const double forwards = b[j] * c[k];
        const double backwards = b[k] * c[j];
        sum.add_product(a[i], forwards);
        sum.add_product(-a[i], backwards);
        sum.add_product(a[i], std::fma(b[j], c[k], -forwards) - std::fma(b[k], c[j], -backwards));
    }
    return sum.value();
}

/// |v|² - r² without cancellation at |v| ≈ r; plain arithmetic has an error of some 1e-15 |v|².
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
