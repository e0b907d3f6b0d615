// SPDX-License-Identifier: MIT
#include "regions/boundary.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/perpendicular.h"

namespace shlight {

Arc<double> whole_circle(const SphericalCap& cap) {
    return {cap.axis, std::numbers::pi, perpendicular(cap.axis), 0, cap.cosine, cap.sine, {}};
}

CapBoundary::CapBoundary(const SphericalCap& cap) {
    const Vec3d& axis = cap.axis;
    if (axis.z <= -cap.sine) {
        return;
    }
    if (axis.z >= cap.sine) {
        arcs_[0] = whole_circle(cap);
        count_ = 1;
        return;
    }
    // The angles φ_a and ψ_0 from one length in which nothing cancels (docs/theory.md, 3.3).
    const double chord = std::sqrt((cap.sine - axis.z) * (cap.sine + axis.z));
    const double radial = std::hypot(axis.x, axis.y);
    const double x = radial > 0 ? axis.x / radial : 1.0;
    const double y = radial > 0 ? axis.y / radial : 0.0;
    const Vec3d uphill(-axis.z * x, -axis.z * y, radial);
    arcs_[0] = {axis, std::atan2(chord, -cap.cosine * axis.z), uphill, 0, cap.cosine, cap.sine, {}};
    arcs_[1] = {{0, 0, 1}, std::atan2(chord, cap.cosine), {x, y, 0}, 0, 0, 1, {}};
    count_ = 2;
}

std::vector<Arc<double>> polygon_boundary(const SphericalPolygon& polygon) {
    std::vector<Arc<double>> arcs;
    const std::vector<Vec3d>& v = polygon.directions();
    for (std::size_t i = 0; i < v.size(); ++i) {
        const double sine = glm::length(polygon.edge_cross(i));
        if (sine > 0) {
            const Vec3d axis = polygon.edge_cross(i) / sine;
            const double half = std::atan2(sine, glm::dot(v[i], v[(i + 1) % v.size()])) / 2;
            const Vec3d middle = std::cos(half) * v[i] + std::sin(half) * glm::cross(axis, v[i]);
            arcs.push_back({axis, half, middle, 0, 0, 1, {}});
        }
    }
    return arcs;
}

}  // namespace shlight
