// SPDX-License-Identifier: MIT
#include "math/gauss_legendre.h"

#include <cmath>
#include <cstddef>
#include <numbers>

#include "base/double_double.h"

namespace shlight {
namespace {

/// P_n and P_n' at x.
template <class Real>
struct LegendreValue {
    Real value, derivative;
};

template <class Real>
LegendreValue<Real> legendre(int n, const Real& x) {
    Real before = 1;
    Real p = x;
    for (int k = 2; k <= n; ++k) {
        const Real next = (Real(2 * k - 1) * x * p - Real(k - 1) * before) / Real(k);
        before = p;
        p = next;
    }
    return {p, Real(n) * (x * p - before) / (x * x - Real(1))};
}

GaussRule make_rule(int n) {
    const auto size = static_cast<std::size_t>(n);
    GaussRule rule{std::vector<double>(size), std::vector<double>(size)};
    for (std::size_t i = 0; i < size; ++i) {
        // Newton's method from Tricomi's estimate converges to the last bits in four steps for every n here. A step
        // with twice as many digits leaves no error but that of rounding the node.
        double start = std::cos(std::numbers::pi * (static_cast<double>(i) + 0.75) / (n + 0.5));
        for (int step = 0; step < 4; ++step) {
            const LegendreValue<double> p = legendre(n, start);
            start -= p.value / p.derivative;
        }
        const LegendreValue<DoubleDouble> p = legendre(n, DoubleDouble(start));
        const DoubleDouble x = start - p.value / p.derivative;
        const DoubleDouble d = legendre(n, x).derivative;
        rule.nodes[size - 1 - i] = static_cast<double>((1 + x) / 2);
        rule.weights[size - 1 - i] = static_cast<double>(1 / ((1 - x * x) * d * d));
    }
    return rule;
}

std::vector<GaussRule> make_rules() {
    std::vector<GaussRule> rules{{}, {{0.5}, {1.0}}};
    for (int n = 2; n <= kMaxGaussPoints; ++n) {
        rules.push_back(make_rule(n));
    }
    return rules;
}

}  // namespace

const GaussRule& gauss_rule(int points) {
    static const std::vector<GaussRule> rules = make_rules();
    return rules.at(static_cast<std::size_t>(points));
}

}  // namespace shlight
