// SPDX-License-Identifier: MIT
#include "math/gauss_legendre.h"

#include <cmath>
#include <cstddef>
#include <numbers>

namespace shlight {
namespace {

/// P_n and P_n' at x.
struct LegendreValue {
    long double value, derivative;
};

LegendreValue legendre(int n, long double x) {
    long double before = 1;
    long double p = x;
    for (int k = 2; k <= n; ++k) {
        const long double next =
            (static_cast<long double>(2 * k - 1) * x * p - static_cast<long double>(k - 1) * before) /
            static_cast<long double>(k);
        before = p;
        p = next;
    }
    return {p, static_cast<long double>(n) * (x * p - before) / (x * x - 1)};
}

GaussRule make_rule(int n) {
    const auto size = static_cast<std::size_t>(n);
    GaussRule rule{std::vector<double>(size), std::vector<double>(size)};
    for (std::size_t i = 0; i < size; ++i) {
        // Newton's method from Tricomi's estimate converges to the last bit in four steps for every n here.
        long double x = std::cos(std::numbers::pi_v<long double> * (static_cast<long double>(i) + 0.75L) /
                                 (static_cast<long double>(n) + 0.5L));
        for (int step = 0; step < 5; ++step) {
            const LegendreValue p = legendre(n, x);
            x -= p.value / p.derivative;
        }
        const long double d = legendre(n, x).derivative;
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
