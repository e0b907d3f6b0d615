// SPDX-License-Identifier: MIT
#include "regions/cap_constants.h"

#include <memory>
#include <numbers>

namespace shlight {
namespace {

template <class T>
CapBand<T> band(int l) {
    const double twice = 2 * l + 1;
    const double pi = std::numbers::pi;
    const auto r = [](double x) { return static_cast<T>(x); };
    const double diagonal = LegendreConstants<double>::get().diagonal[static_cast<std::size_t>(l)];
    const double square = l * (l + 1);
    return {r(diagonal),
            r(diagonal / (l + 1)),
            r(l > 0 ? 2 / std::sqrt(square) : 0),
            r(4 * pi / twice),
            r(l > 0 ? 1 / square : 0),
            r(std::sqrt(twice / (4 * pi))),
            r(l > 0 ? static_cast<double>(l - 1) / l : 0),
            r(l > 0 ? static_cast<double>(2 * l - 1) / l : 0)};
}

template <class T>
CapDegree<T> degree(int m) {
    const auto r = [](double x) { return static_cast<T>(x); };
    return {r(m > 0 ? 4.0 / m : 0), r(m > 1 ? 2.0 / (m * m - 1) : 0), r(m + 1)};
}

/// P̄_l^m(0) for one band from the band two before; zero where l - m is odd, and for m = l + 1.
using PlaneRow = std::array<double, kMaxOrder + 1>;

PlaneRow next_on_plane(int l, const PlaneRow& two_before) {
    const auto& legendre = LegendreConstants<double>::get();
    PlaneRow row{};
    for (int m = 0; m < l; ++m) {
        row[static_cast<std::size_t>(m)] = -legendre.back[at(l, m)] * two_before[static_cast<std::size_t>(m)];
    }
    row[static_cast<std::size_t>(l)] = legendre.diagonal[static_cast<std::size_t>(l)];
    return row;
}

template <class T>
void fill_steps(int l, const PlaneRow& values, CapStep<T>* steps) {
    const double* ladder = &LegendreConstants<double>::get().ladder[at(l, 0)];
    const auto r = [](double x) { return static_cast<T>(x); };
    for (int m = 0; m <= l; ++m) {
        steps[m] = {r(m > 0 ? 2 * m / ladder[m - 1] : 0),
                    r(m > 0 ? ladder[m] / ladder[m - 1] : 0),
                    r(m > 0 && m < l ? 2 * m / ladder[m] : 0),
                    r(m > 0 && m < l ? ladder[m - 1] / ladder[m] : 0),
                    r(m > 0 ? 2 / ladder[m - 1] : 0),
                    r(m > 0 ? 2 * values[static_cast<std::size_t>(m)] / ladder[m - 1] : 0),
                    r(ladder[m])};
    }
}

template <class T>
std::unique_ptr<const CapConstants<T>> make_constants() {
    auto constants = std::make_unique<CapConstants<T>>();
    PlaneRow before{}, row{};
    for (int l = 0; l < kMaxOrder; ++l) {
        const PlaneRow next = next_on_plane(l, before);
        before = row;
        row = next;
        fill_steps(l, row, &constants->steps[at(l, 0)]);
        constants->bands[static_cast<std::size_t>(l)] = band<T>(l);
        constants->degrees[static_cast<std::size_t>(l)] = degree<T>(l);
    }
    return constants;
}

}  // namespace

template <class T>
const CapConstants<T>& CapConstants<T>::get() {
    static const std::unique_ptr<const CapConstants<T>> constants = make_constants<T>();
    return *constants;
}

template struct CapConstants<float>;
template struct CapConstants<double>;

}  // namespace shlight
