// SPDX-License-Identifier: MIT
#include "regions/cap_checks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/checks.h"
#include "base/exact_sums.h"
#include "base/safe_length.h"
#include "regions/cap_arrays.h"

namespace shlight {

void check_sphere(const Vec3d& center, double radius, double epsilon) {
    check_finite("centers", center);
    if (!(std::isfinite(radius) && radius > 0)) {
        reject("radii must be positive and finite");
    }
    const double farthest = std::max({std::abs(center.x), std::abs(center.y), std::abs(center.z)});
    const double scale = safe_scale({farthest, radius, 0});
    const Vec3d c = center * scale;
    const double r = radius * scale;
    // Contact within the rounding of the inputs is contact.
    if (difference_of_squares({c.x, c.y, c.z}, r) < -4 * epsilon * r * r) {
        reject("radii: the shading point lies inside a sphere (|center| < radius)");
    }
}

template <class T>
void check_spheres(std::span<const Vec3<T>> centers, std::span<const T> radii, double epsilon) {
    for (std::size_t i = sound_spheres(centers.data(), radii.data(), centers.size()); i < centers.size(); ++i) {
        const Vec3d center(centers[i]);
        check_sphere(center, static_cast<double>(radii[i]), epsilon);
        // The kernels of floats divide by this distance.
        if (sizeof(T) == 4 && safe_length(center) < std::numeric_limits<float>::min()) {
            reject("centers: in float32 a sphere's centre must be 1.2e-38 or more from the shading point");
        }
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
