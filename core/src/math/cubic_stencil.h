// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace shlight {

/// Weights of cubic interpolation between four equally spaced nodes. position: in units of their distance.
struct CubicStencil {
    int first;
    std::array<float, 4> weights;

    /// least: smallest node index that may be used; count: one more than the largest. NaN counts as a position beyond
    /// it.
    CubicStencil(double position, int least, int count)
        : first(static_cast<int>(std::max<double>(least, std::min<double>(count - 4, std::floor(position) - 1)))) {
        const auto t = static_cast<float>(position - first);  // 1 … 2 between the middle nodes
        weights = {-(t - 1) * (t - 2) * (t - 3) / 6, t * (t - 2) * (t - 3) / 2, -t * (t - 1) * (t - 3) / 2,
                   t * (t - 1) * (t - 2) / 6};
    }
};

}  // namespace shlight
