// SPDX-License-Identifier: MIT
#include "quad_math.h"

#include <array>
#include <map>
#include <mutex>

namespace shlight::truth {

namespace {

/// P_n and P_n' at x by Bonnet's recurrence.
std::array<quad, 2> legendre_and_derivative(int n, quad x) {
    quad previous = 1;
    quad current = x;
    for (int k = 2; k <= n; ++k) {
        const quad next = ((2 * k - 1) * x * current - (k - 1) * previous) / k;
        previous = current;
        current = next;
    }
    return {current, n * (x * current - previous) / (x * x - 1)};
}

GaussRule compute_gauss_rule(int count) {
    GaussRule rule;
    for (int i = 0; i < count; ++i) {
        quad x = std::cos(3.14159265358979 * (i + 0.75) / (count + 0.5));
        for (int step = 0; step < 5; ++step) {
            const auto [value, derivative] = legendre_and_derivative(count, x);
            x -= value / derivative;
        }
        const quad derivative = legendre_and_derivative(count, x)[1];
        rule.nodes.push_back(x);
        rule.weights.push_back(2 / ((1 - x * x) * derivative * derivative));
    }
    return rule;
}

/// Values computed on first use; references stay valid.
template <class Value, class Compute>
const Value& computed_once(int key, Compute compute) {
    static std::mutex mutex;
    static std::map<int, Value> values;
    const std::lock_guard lock(mutex);
    const auto found = values.find(key);
    return found != values.end() ? found->second : values.emplace(key, compute(key)).first->second;
}

}  // namespace

quad pi() {
    static const quad value = 4 * atan2f128(1, 1);
    return value;
}

const GaussRule& gauss_rule(int count) {
    return computed_once<GaussRule>(count, compute_gauss_rule);
}

const OrderTables& order_tables(int order) {
    return computed_once<OrderTables>(order, [](int n) { return OrderTables(n); });
}

OrderTables::OrderTables(int bands)
    : order(bands), a(cosine_count(bands)), b(cosine_count(bands)), diagonal(bands), derivative(bands) {
    for (int m = 0; m < bands; ++m) {
        diagonal[m] = m == 0 ? 1 / sqrtf128(4 * pi()) : diagonal[m - 1] * sqrtf128(quad(2 * m + 1) / (2 * m));
        derivative[m] = sqrtf128(quad(m) * (m + 1));
    }
    for (int l = 1; l < bands; ++l) {
        for (int m = 0; m < l; ++m) {
            const quad ratio = quad(4 * l * l - 1) / (l * l - m * m);
            a[cosine_index(l, m)] = sqrtf128(ratio);
            if (l - 1 > m) {
                const int k = l - 1;
                b[cosine_index(l, m)] = sqrtf128(ratio * (k * k - m * m) / (4 * k * k - 1));
            }
        }
    }
}

void reduced_legendre(const OrderTables& tables, quad z, std::vector<quad>& values) {
    values.resize(cosine_count(tables.order));
    for (int m = 0; m < tables.order; ++m) {
        quad before = 0;
        quad value = tables.diagonal[m];
        values[cosine_index(m, m)] = value;
        for (int l = m + 1; l < tables.order; ++l) {
            const int i = cosine_index(l, m);
            const quad next = tables.a[i] * z * value - tables.b[i] * before;
            before = value;
            value = next;
            values[i] = value;
        }
    }
}

Coefficients rounded(const std::vector<quad>& values) {
    Coefficients result;
    for (const quad value : values) {
        const auto high = static_cast<double>(value);
        result.high.push_back(high);
        result.low.push_back(static_cast<double>(value - high));
    }
    return result;
}

template <class T>
double largest_error(const Coefficients& reference, int order, const T* computed) {
    double largest = 0;
    for (int i = 0; i < coefficient_count(order); ++i) {
        const double error = std::abs((static_cast<double>(computed[i]) - reference.high[i]) - reference.low[i]);
        if (!(error <= largest)) {
            largest = error;
        }
        if (std::isnan(largest)) {
            return largest;
        }
    }
    return largest;
}

template double largest_error(const Coefficients&, int, const float*);
template double largest_error(const Coefficients&, int, const double*);

}  // namespace shlight::truth
