// SPDX-License-Identifier: MIT
#include "lobes/view_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace shlight {

double view_angle(int node) {
    return std::numbers::pi / 2 * node / (kViewNodes - 1);
}

ViewStencil::ViewStencil(float cos_theta_o) {
    const float theta = std::acos(std::clamp(cos_theta_o, 0.0F, 1.0F));
    const float position = theta * (static_cast<float>(kViewNodes - 1) * 2 / std::numbers::pi_v<float>);
    const int first = std::clamp(static_cast<int>(position) - 1, -1, kViewNodes - 4);
    const float t = position - static_cast<float>(first);  // 0 … 3 over the four nodes, 1 … 2 in the interior
    even = {-(t - 1) * (t - 2) * (t - 3) / 6, t * (t - 2) * (t - 3) / 2, -t * (t - 1) * (t - 3) / 2,
            t * (t - 1) * (t - 2) / 6};
    for (int i = 0; i < 4; ++i) {
        nodes[i] = static_cast<std::size_t>(std::abs(first + i));
        odd[i] = first + i < 0 ? -even[i] : even[i];
    }
}

}  // namespace shlight
