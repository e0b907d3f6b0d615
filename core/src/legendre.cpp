// SPDX-License-Identifier: MIT
#include "legendre.h"

#include <memory>
#include <numbers>

namespace shlight {
namespace {

struct Exact {
    std::array<double, kMaxOrder> diagonal{};
    std::array<double, kCosineMax> step{}, back{}, ladder{}, at_horizon{}, dz_at_horizon{};
};

void fill_recurrence(Exact& c) {
    c.diagonal[0] = std::sqrt(1 / (4 * std::numbers::pi));
    for (std::size_t m = 1; m < kMaxOrder; ++m) {
        const auto d = static_cast<double>(m);
        c.diagonal[m] = c.diagonal[m - 1] * std::sqrt((2 * d + 1) / (2 * d));
    }
    for (int l = 0; l < kMaxOrder; ++l) {
        for (int m = 0; m <= l; ++m) {
            c.ladder[at(l, m)] = std::sqrt(static_cast<double>((l - m) * (l + m + 1)));
            if (m == l) {
                continue;
            }
            const double a = std::sqrt((4.0 * l * l - 1) / (l * l - m * m));
            const double k = l - 1;
            c.step[at(l, m)] = a;
            c.back[at(l, m)] = l - 1 > m ? a * std::sqrt((k * k - m * m) / (4 * k * k - 1)) : 0.0;
        }
    }
}

void fill_horizon(Exact& c) {
    for (int m = 0; m < kMaxOrder; ++m) {
        c.at_horizon[at(m, m)] = c.diagonal[static_cast<std::size_t>(m)];
        for (int l = m + 2; l < kMaxOrder; l += 2) {
            c.at_horizon[at(l, m)] = -c.back[at(l, m)] * c.at_horizon[at(l - 2, m)];
        }
    }
    // (1 - z²) dP̄_l^m/dz = √((2l+1)/(2l-1) (l²-m²)) P̄_{l-1}^m - l z P̄_l^m, at z = 0.
    for (int l = 1; l < kMaxOrder; ++l) {
        for (int m = 0; m < l; ++m) {
            c.dz_at_horizon[at(l, m)] =
                std::sqrt((2.0 * l + 1) / (2.0 * l - 1) * (l * l - m * m)) * c.at_horizon[at(l - 1, m)];
        }
    }
}

template <class T, std::size_t N>
std::array<T, N> rounded(const std::array<double, N>& values) {
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
    fill_horizon(*exact);
    auto c = std::make_unique<LegendreConstants<T>>();
    c->diagonal = rounded<T>(exact->diagonal);
    c->step = rounded<T>(exact->step);
    c->back = rounded<T>(exact->back);
    c->ladder = rounded<T>(exact->ladder);
    c->at_horizon = rounded<T>(exact->at_horizon);
    c->dz_at_horizon = rounded<T>(exact->dz_at_horizon);
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
