// SPDX-License-Identifier: MIT
#include "kernels/potential_constants.h"

#include <array>
#include <cmath>
#include <mutex>
#include <numbers>

#include "legendre.h"

namespace shlight {
namespace {

/// Of the monic multiples of P̂_l^m, P̃_{l+1} = z P̃_l - β_l P̃_{l-1}.
double beta(int l, int m) {
    return static_cast<double>(l * l - m * m) / (4.0 * l * l - 1);
}

/// P̃_l = scale q_l for l = m … order, and what a degree's series take.
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

const PotentialConstants& PotentialConstants::of(int order) {
    static std::array<std::once_flag, kMaxOrder + 1> flags;
    static std::array<PotentialConstants, kMaxOrder + 1> constants;
    std::call_once(flags[order], [&] { constants[order] = make(order); });
    return constants[order];
}

}  // namespace shlight
