// SPDX-License-Identifier: MIT
//
// What must hold of every answer. What does not ends the process with a line that says so.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <ranges>
#include <span>
#include <stdexcept>

#include "shlight/types.h"

namespace shlight::fuzzing {

[[noreturn]] inline void fail(const char* what, double by = 0) {
    std::fprintf(stderr, "shlight: %s: %.17g\n", what, by);
    std::abort();
}

/// `value` ≤ `bound`, which NaN is not.
inline void check_most(const char* what, double value, double bound) {
    if (!(value <= bound)) {
        fail(what, value);
    }
}

/// Whether the call answers. Bad arguments are refused by std::invalid_argument and by nothing else.
template <class Call>
bool answers(const Call& call) {
    try {
        call();
    } catch (const std::invalid_argument&) {
        return false;
    }
    return true;
}

template <class Numbers>
void check_finite(const char* what, const Numbers& numbers) {
    for (const auto number : numbers) {
        check_most(what, std::abs(static_cast<double>(number)), std::numeric_limits<double>::max());
    }
}
inline void check_finite(const char* what, const Vec3d& v) {
    check_finite(what, std::array{v.x, v.y, v.z});
}
inline void check_unit(const char* what, const Vec3d& v, double slack) {
    check_most(what, std::abs(glm::length(v) - 1), slack);
}

/// Granted errors of coefficients: shares of what the solid angle allows, and of the sphere.
struct Slack {
    double relative, absolute;
};
template <class T>
constexpr Slack kSlack = sizeof(T) == 4 ? Slack{1e-4, 1e-6} : Slack{1e-8, 1e-12};

/// The largest length of a band's vector: Σ_m Y_lm² = (2l + 1)/4π everywhere, so that no band of a region of solid
/// angle Ω is longer than √((2l + 1)/4π) Ω, which is √(2l + 1) L_00.
inline double band_bound(int l, double first, const Slack& slack) {
    return std::sqrt(2 * l + 1) * (std::abs(first) * (1 + slack.relative) + slack.absolute);
}

/// Checks coefficients of a region of unit radiance; `largest`: of its solid angles.
template <class T>
void check_bands(std::span<const T> coefficients, int order, double largest, const Slack& slack) {
    check_finite("a coefficient is not finite", coefficients);
    const auto first = static_cast<double>(coefficients[0]);
    check_most("the solid angle is negative", -first, slack.absolute);
    check_most("the solid angle is too large", first, largest / std::sqrt(4 * std::numbers::pi) * (1 + slack.relative));
    for (int l = 1; l < order; ++l) {
        double square = 0;
        for (int m = -l; m <= l; ++m) {
            square += std::pow(static_cast<double>(coefficients[static_cast<std::size_t>(coefficient_index(l, m))]), 2);
        }
        check_most("a band exceeds what the solid angle allows", std::sqrt(square), band_bound(l, first, slack));
    }
}

/// Checks that two lists of coefficients are those of one region.
template <class T>
void check_alike(const char* what, std::span<const T> a, std::span<const T> b, const Slack& slack) {
    for (std::size_t i = 0; i < a.size(); ++i) {
        const auto l = static_cast<int>(std::sqrt(static_cast<double>(i)));
        check_most(what, std::abs(static_cast<double>(a[i] - b[i])),
                   2 * std::sqrt(2 * l + 1) * (slack.relative * std::abs(static_cast<double>(a[0])) + slack.absolute));
    }
}

}  // namespace shlight::fuzzing
