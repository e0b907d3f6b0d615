// SPDX-License-Identifier: MIT
#include "regions/moment_constants.h"

#include <memory>
#include <numbers>

namespace shlight {

template <class T>
MomentSteps<T>::MomentSteps() {
    const auto& constants = LegendreConstants<double>::get();
    MomentStep<T>* step = steps_.data();
    for (int m = 1; m < kMaxOrder; ++m) {
        double scale = constants.diagonal[m];
        double value = 1;
        double before = 0;
        for (int l = m; l < kMaxOrder; ++l, ++step) {
            scale *= l > m ? constants.step[at(l, m)] : 1;
            const double stokes = l > 1 ? scale / (l * (l + 1)) : 0;
            const double beta = static_cast<double>(l * l - m * m) / (4.0 * l * l - 1);
            const double down = stokes * (m > 1 ? std::numbers::sqrt2 : 1) * constants.ladder[at(l, m - 1)];
            *step = {static_cast<T>(beta), static_cast<T>(down), static_cast<T>(stokes * std::numbers::sqrt2 * m),
                     static_cast<T>(down * value)};
            const double next = -beta * before;
            before = value;
            value = next;
        }
    }
}

template <class T>
const MomentSteps<T>& MomentSteps<T>::get() {
    static const std::unique_ptr<const MomentSteps> steps(new MomentSteps());
    return *steps;
}

template class MomentSteps<float>;
template class MomentSteps<double>;

}  // namespace shlight
