// SPDX-License-Identifier: MIT
#include "shlight/horizon.h"

#include "legendre.h"

namespace shlight {

template <class T>
Horizon<T>::Horizon(double height, double sine, int order) : height_(height), sine_(sine), order_(order) {
    std::array<double, kMaxOrder> sine_powers;
    powers(sine, order, sine_powers.data());
    LegendreRows<double> legendre(height, sine * sine);
    values_[0] = static_cast<T>(sine * legendre[0]);
    slopes_[0] = 0;
    for (int l = 1; l < order; ++l) {
        legendre.advance();
        std::array<double, kMaxOrder + 1> value;
        for (int m = 0; m <= l; ++m) {
            value[m] = sine * sine_powers[m] * legendre[m];
            values_[at(l, m)] = static_cast<T>(value[m]);
        }
        value[l + 1] = 0;
        // By the ladder operators: s_0² dP̄_l^m/dz = -l z_0 P̄_l^m + … P̄_{l-1}^m would be a small difference at the
        // poles.
        const double* ladder = &LegendreConstants<double>::get().ladder[at(l, 0)];
        slopes_[at(l, 0)] = static_cast<T>(ladder[0] * value[1]);
        for (int m = 1; m <= l; ++m) {
            slopes_[at(l, m)] = static_cast<T>((ladder[m] * value[m + 1] - ladder[m - 1] * value[m - 1]) / 2);
        }
    }
}

template <class T>
const Horizon<T>& Horizon<T>::plane() {
    static const Horizon horizon(0, 1, kMaxOrder);
    return horizon;
}

template class Horizon<float>;
template class Horizon<double>;

}  // namespace shlight
