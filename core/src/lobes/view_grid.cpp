// SPDX-License-Identifier: MIT
#include "lobes/view_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "math/cubic_stencil.h"
#include "math/legendre.h"

namespace shlight {

double view_angle(int node) {
    return std::numbers::pi / 2 * node / (kViewNodes - 1);
}

double view_position(double cos_theta_o) {
    return std::acos(std::max(0.0, std::min(1.0, cos_theta_o))) * ((kViewNodes - 1) * 2 / std::numbers::pi);
}

ViewInterval::ViewInterval(double cos_theta_o) {
    const double position = view_position(cos_theta_o);
    low = std::min(static_cast<std::size_t>(position), std::size_t{kViewNodes - 2});
    t = position - static_cast<double>(low);
}

template <class T>
void interpolate_terms(std::span<const T> rows, float cos_theta_o, int order, T* cosine_terms) {
    if (rows.size() == kCosineMax) {
        std::copy_n(rows.begin(), cosine_count(order), cosine_terms);
        return;
    }
    const CubicStencil s(view_position(double{cos_theta_o}), -1, kViewNodes);
    std::array<const T*, 4> from;
    std::array<std::array<T, 4>, 2> weights;  // of even and of odd degrees
    for (int i = 0; i < 4; ++i) {
        const int node = s.first + i;
        from[i] = &rows[static_cast<std::size_t>(std::abs(node)) * kCosineMax];
        weights[0][i] = s.weights[i];
        weights[1][i] = node < 0 ? -s.weights[i] : s.weights[i];
    }
    std::size_t i = 0;
    for (int l = 0; l < order; ++l) {
        for (int m = 0; m <= l; ++m, ++i) {
            const auto& w = weights[m % 2];
            cosine_terms[i] = w[0] * from[0][i] + w[1] * from[1][i] + w[2] * from[2][i] + w[3] * from[3][i];
        }
    }
}

float interpolate_even(std::span<const float> nodes, float cos_theta_o) {
    const CubicStencil s(view_position(double{cos_theta_o}), -1, kViewNodes);
    float sum = 0;
    for (int i = 0; i < 4; ++i) {
        sum += s.weights[i] * nodes[static_cast<std::size_t>(std::abs(s.first + i))];
    }
    return sum;
}

template void interpolate_terms(std::span<const float>, float, int, float*);
template void interpolate_terms(std::span<const double>, float, int, double*);

}  // namespace shlight
