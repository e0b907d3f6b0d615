// SPDX-License-Identifier: MIT
#include "regions/boundary_constants.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "base/recent_values.h"

namespace shlight {
namespace {

/// β_l of the recurrence of the monic multiples of P̂_l^m, P̃_{l+1} = z P̃_l - β_l P̃_{l-1}.
double beta(int l, int m) {
    return static_cast<double>(l * l - m * m) / (4.0 * l * l - 1);
}

/// P̃_l = scale q_l for l = m … order.
struct Scales {
    std::array<double, kMaxOrder + 1> scale;

    Scales(int m, int order) {
        scale[m] = 1;
        scale[m + 1] = std::sqrt(beta(m + 1, m));
        for (int l = m + 1; l < order; ++l) {
            scale[l + 1] = beta(l, m) * scale[l - 1];
        }
    }
};

PotentialConstants make(int order) {
    const auto& constants = LegendreConstants<double>::get();
    PotentialConstants c;
    for (int m = order - 1; m > 0; --m) {
        const Scales scales(m, order);
        double norm = constants.diagonal[m];  // P̂ / P̃
        for (int l = m + 1; l < order; ++l) {
            norm *= constants.step[at(l, m)];
        }
        for (int l = order - 1; l >= m; --l) {
            // Band 1 has a closed form.
            const double stokes = l > 1 ? norm * scales.scale[l] / (l * (l + 1)) : 0;
            const double pair = m > 1 ? std::numbers::sqrt2 : 1;
            c.rise.push_back(scales.scale[l] / scales.scale[l + 1]);
            c.down.push_back(stokes * pair * constants.ladder[at(l, m - 1)]);
            c.same.push_back(stokes * std::numbers::sqrt2 * m);
            c.term.push_back(static_cast<std::uint16_t>(cosine_index(l, m)));
            norm /= l > m ? constants.step[at(l, m)] : 1;
        }
    }
    return c;
}

}  // namespace

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

const PotentialConstants& PotentialConstants::of(int order) {
    static const ValuesByNumber<PotentialConstants> constants(kMaxOrder + 1);
    return constants.get(static_cast<std::size_t>(order), [&] { return make(order); });
}

}  // namespace shlight
