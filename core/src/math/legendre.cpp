// SPDX-License-Identifier: MIT
#include "math/legendre.h"

#include <memory>

#include "base/double_double.h"

namespace shlight {
namespace {

/// Constants are computed with twice the digits of a double, because products of 63 square roots would add their
/// rounding to every light.
using Real = DoubleDouble;

struct Exact {
    std::array<Real, kMaxOrder> diagonal{};
    std::array<Real, kCosineMax> step{}, back{}, ladder{}, at_pole{};
};

void fill_recurrence(Exact& c) {
    c.diagonal[0] = sqrt(1 / (4 * kPiInDoubles));
    for (std::size_t m = 1; m < kMaxOrder; ++m) {
        const auto d = static_cast<double>(m);
        c.diagonal[m] = c.diagonal[m - 1] * sqrt(Real(2 * d + 1) / (2 * d));
    }
    for (int l = 0; l < kMaxOrder; ++l) {
        for (int m = 0; m < l; ++m) {
            c.ladder[at(l, m)] = sqrt(Real((l - m) * (l + m + 1)));
            const Real a = sqrt(Real(4 * l * l - 1) / (l * l - m * m));
            const double k = l - 1;
            c.step[at(l, m)] = a;
            c.back[at(l, m)] = l - 1 > m ? a * sqrt(Real(k * k - m * m) / (4 * k * k - 1)) : Real(0);
        }
    }
}

void fill_pole(Exact& c) {
    for (int m = 0; m < kMaxOrder; ++m) {
        c.at_pole[at(m, m)] = c.diagonal[m];
        for (int l = m + 1; l < kMaxOrder; ++l) {
            const Real before = l > m + 1 ? c.at_pole[at(l - 2, m)] : Real(0);
            c.at_pole[at(l, m)] = c.step[at(l, m)] * c.at_pole[at(l - 1, m)] - c.back[at(l, m)] * before;
        }
    }
}

template <class T, std::size_t N>
std::array<T, N> rounded(const std::array<Real, N>& values) {
    std::array<T, N> out{};
    for (std::size_t i = 0; i < N; ++i) {
        out[i] = static_cast<T>(values[i]);
    }
    return out;
}

template <class T>
std::unique_ptr<const LegendreConstants<T>> make_constants() {
    auto exact = std::make_unique<Exact>();
    fill_recurrence(*exact);
    fill_pole(*exact);
    auto c = std::make_unique<LegendreConstants<T>>();
    c->diagonal = rounded<T>(exact->diagonal);
    c->step = rounded<T>(exact->step);
    c->back = rounded<T>(exact->back);
    c->ladder = rounded<T>(exact->ladder);
    c->at_pole = rounded<T>(exact->at_pole);
    return c;
}

}  // namespace

template <class T>
const LegendreConstants<T>& LegendreConstants<T>::get() {
    static const std::unique_ptr<const LegendreConstants<T>> constants = make_constants<T>();
    return *constants;
}

template struct LegendreConstants<float>;
template struct LegendreConstants<double>;

}  // namespace shlight
