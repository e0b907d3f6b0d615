// SPDX-License-Identifier: MIT
#include "tracing/terminator.h"

#include <limits>

namespace shlight {

Vec3d lift_to_smooth_surface(const std::array<Vec3d, 3>& corners, const std::array<Vec3d, 3>& normals,
                             const std::array<double, 3>& weights) {
    const Vec3d point = weighted(corners, weights);
    // A convex surface lies below the corners' tangent planes. A corner that sees another one above its plane has a
    // concave surface before it, and its plane counts as raised to that corner.
    double envelope = std::numeric_limits<double>::infinity();
    double quadratic = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        double rise = 0;
        for (std::size_t j = 0; j < 3; ++j) {
            rise = std::max(rise, glm::dot(corners[j] - corners[i], normals[i]));
        }
        envelope = std::min(envelope, std::max(rise + glm::dot(corners[i] - point, normals[i]), 0.0));
        // Along an edge whose normals turn by a slope s over its length d, a parabola stands s d w_i w_j / 2 above it.
        const std::size_t next = (i + 1) % 3;
        const double bend = glm::dot(normals[next] - normals[i], corners[next] - corners[i]);
        quadratic += 0.5 * bend * weights[i] * weights[next];
    }
    return std::max(envelope, quadratic) * weighted(normals, weights);
}

}  // namespace shlight
