// SPDX-License-Identifier: MIT
#include "regions/motion_constants.h"

#include <cmath>
#include <numbers>

#include "math/legendre.h"

namespace shlight {
namespace {

/// The factors of Eqs. 47 to 49 of docs/theory.md.
template <class T>
MotionStep<T> step_of(int band, int degree, double at_equator) {
    const double l = band;
    const double m = degree;
    const double above = (2 * l + 1) * (2 * l + 3);
    const double below = std::abs((2 * l - 1) * (2 * l + 1));
    const auto number = [](double factor, double square) { return static_cast<T>(factor * std::sqrt(square)); };
    return {number(0.5, (l - m) * (l + m + 1)),
            number(0.5, (l + m) * (l - m + 1)),
            number((l + 2) / 2, (l + m + 1) * (l + m + 2) / above),
            number((l + 2) / 2, (l - m + 1) * (l - m + 2) / above),
            number(-(l + 2), ((l + 1) * (l + 1) - m * m) / above),
            number((l - 1) / 2, (l - m) * std::abs(l - m - 1) / below),
            number((l - 1) / 2, (l + m) * std::abs(l + m - 1) / below),
            number(l - 1, (l * l - m * m) / below),
            static_cast<T>((band - degree) % 2 == 0 ? std::numbers::sqrt2 * at_equator : 0)};
}

}  // namespace

template <class T>
const std::vector<MotionStep<T>>& motion_steps() {
    static const std::vector<MotionStep<T>> steps = [] {
        std::vector<MotionStep<T>> made;
        LegendreRows<double> legendre(0, 1);
        for (int l = 0; l < kMaxOrder; ++l) {
            for (int m = 0; m <= l; ++m) {
                made.push_back(step_of<T>(l, m, legendre[m]));
            }
            if (l + 1 < kMaxOrder) {
                legendre.advance();
            }
        }
        return made;
    }();
    return steps;
}

template const std::vector<MotionStep<float>>& motion_steps();
template const std::vector<MotionStep<double>>& motion_steps();

}  // namespace shlight
