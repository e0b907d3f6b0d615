// SPDX-License-Identifier: MIT
#include "caps/cap_checks.h"

#include <cmath>
#include <numbers>

#include "base/checks.h"
#include "base/exact_sums.h"
#include "caps/circle_batch.h"

namespace shlight {

void check_sphere(const Vec3d& center, double radius, double epsilon) {
    check_finite("centers", center);
    if (!(std::isfinite(radius) && radius > 0)) {
        reject("radii must be positive and finite");
    }
    // Contact within the rounding of the inputs is contact.
    if (difference_of_squares({center.x, center.y, center.z}, radius) < -4 * epsilon * radius * radius) {
        reject("radii: the shading point lies inside a sphere (|center| < radius)");
    }
}

template <class T>
void check_spheres(std::span<const Vec3<T>> centers, std::span<const T> radii, double epsilon) {
    for (std::size_t i = sound_spheres(centers.data(), radii.data(), centers.size()); i < centers.size(); ++i) {
        check_sphere(Vec3d(centers[i]), static_cast<double>(radii[i]), epsilon);
    }
}

void check_cap(const Vec3d& axis, double half_angle) {
    check_finite("axes", axis);
    if (axis == Vec3d(0)) {
        reject("axes contains a zero vector");
    }
    if (!(half_angle > 0 && half_angle <= std::numbers::pi * (1 + 1e-7))) {
        reject("half_angles must lie in (0, π]");
    }
}

template void check_spheres(std::span<const Vec3<float>>, std::span<const float>, double);
template void check_spheres(std::span<const Vec3<double>>, std::span<const double>, double);

}  // namespace shlight
