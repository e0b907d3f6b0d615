// SPDX-License-Identifier: MIT
#include "regions/potential_constants.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <numbers>

#include "math/legendre.h"

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

/// Appends what U_count-1 … U_0 have of the polynomials q of a degree. rise: of its `count` terms.
void add_chebyshev(const double* rise, std::size_t count, std::vector<double>& out) {
    using Row = std::array<double, kMaxChebyshevOrder + 2>;  // of U_k at k + 1; U_{-1} = 0
    std::array<Row, kMaxChebyshevOrder> q{};
    q[0][1] = 1;
    for (std::size_t j = 0; j + 1 < count; ++j) {
        // z U_k = (U_{k-1} + U_{k+1}) / 2
        for (std::size_t k = 0; k <= j + 1; ++k) {
            const double before = j > 0 ? q[j - 1][k + 1] : 0;
            q[j + 1][k + 1] = rise[count - 1 - j] / 2 * (q[j][k] + q[j][k + 2]) - before;
        }
    }
    for (std::size_t k = count; k-- > 0;) {
        for (std::size_t j = count; j-- > 0;) {
            out.push_back(q[j][k + 1]);
        }
    }
}

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
        if (order <= kMaxChebyshevOrder) {
            const auto count = static_cast<std::size_t>(order - m);
            add_chebyshev(c.rise.data() + c.rise.size() - count, count, c.chebyshev);
        }
    }
    return c;
}

/// Of the normal derivative of each band of the potential, in units of the largest term.
std::vector<double> band_heights(const float* terms, int order) {
    double largest = 0;
    std::vector<double> heights;
    for (int l = 0; l < order; ++l) {
        double square = 0;
        for (int m = 0; m <= l; ++m) {
            const double f = terms[cosine_index(l, m)];
            largest = std::max(largest, std::abs(f));
            square += f * f;
        }
        heights.push_back(std::sqrt(square * (2 * l + 1) / (8 * std::numbers::pi * std::max(1, l * (l + 1)))));
    }
    for (double& height : heights) {
        height = largest > 0 ? height / largest : 0;
    }
    return heights;
}

}  // namespace

GaussErrorGrowth lobe_error_growth(const float* terms, int order) {
    GaussErrorGrowth growth{};
    std::vector<double> share = band_heights(terms, order);
    double before = 1;
    for (std::size_t k = 0; k < growth.size(); ++k) {
        double sum = 0;
        for (int l = 2; l < order; ++l) {
            const double slower = static_cast<double>(l - 1) / (order - 2);
            sum += share[static_cast<std::size_t>(l)] *= slower * slower;
        }
        growth[k] = before > 0 ? kGaussErrorGrowth[k] * sum / before : 0;
        before = sum;
    }
    return growth;
}

const PotentialConstants& PotentialConstants::of(int order) {
    static std::array<std::once_flag, kMaxOrder + 1> flags;
    static std::array<PotentialConstants, kMaxOrder + 1> constants;
    std::call_once(flags[order], [&] { constants[order] = make(order); });
    return constants[order];
}

}  // namespace shlight
