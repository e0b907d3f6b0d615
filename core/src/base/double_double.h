// SPDX-License-Identifier: MIT
//
// Numbers of some 31 digits as sums of two doubles (Dekker 1971; Hida, Li & Bailey 2001), for tables that are computed
// once. Results of +, −, ·, ÷ and √ are right to a few 2⁻¹⁰⁴ as long as a sum does not cancel.
#pragma once

#include <cmath>

namespace shlight {

struct DoubleDouble {
    constexpr DoubleDouble(double value = 0)
        : high(value) {}  // NOLINT(google-explicit-constructor): as an int is a double
    constexpr DoubleDouble(double leading, double rest) : high(leading), low(rest) {}
    /// a + b for |a| ≥ |b|.
    static DoubleDouble sum_of_ordered(double a, double b) {
        const double sum = a + b;
        return {sum, b - (sum - a)};
    }

    constexpr explicit operator double() const { return high; }
    constexpr explicit operator float() const { return static_cast<float>(high); }

    double high, low = 0;  ///< |low| ≤ half a last digit of high
};

inline constexpr DoubleDouble kPiInDoubles(3.141592653589793, 1.2246467991473532e-16);

inline DoubleDouble operator-(const DoubleDouble& a) {
    return {-a.high, -a.low};
}

inline DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
    const double sum = a.high + b.high;
    const double rest = sum - a.high;
    const double error = (a.high - (sum - rest)) + (b.high - rest);
    return DoubleDouble::sum_of_ordered(sum, error + (a.low + b.low));
}

inline DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) {
    return a + -b;
}

inline DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
    const double product = a.high * b.high;
    return DoubleDouble::sum_of_ordered(product,
                                        std::fma(a.high, b.high, -product) + (a.high * b.low + a.low * b.high));
}

inline DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
    const double quotient = a.high / b.high;
    return DoubleDouble::sum_of_ordered(quotient, (a - b * quotient).high / b.high);
}

/// Precondition: x > 0.
inline DoubleDouble sqrt(const DoubleDouble& x) {
    const double root = std::sqrt(x.high);
    return DoubleDouble::sum_of_ordered(root, (x - DoubleDouble(root) * root).high / (2 * root));
}

}  // namespace shlight
