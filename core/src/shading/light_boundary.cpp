// SPDX-License-Identifier: MIT
#include "shading/light_boundary.h"

#include <algorithm>
#include <cmath>

#include "base/perpendicular.h"

namespace shlight {

CapBoundary::CapBoundary(const SphericalCap& cap) {
    const Vec3d& axis = cap.axis;
    if (axis.z <= -cap.sine) {
        return;
    }
    if (axis.z >= cap.sine) {
        const Vec3d from = cap.cosine * axis + cap.sine * perpendicular(axis);
        arcs_[0] = {cap, from, from, true};
        count_ = 1;
        return;
    }
    // The circle meets z = 0 at the azimuths φ_L ± acos(c / sinθ_L). Seen from outside, with z up, +φ is to the right.
    const double radial = std::hypot(axis.x, axis.y);
    const double c = std::min(1.0, cap.cosine / radial);
    const double s = std::sqrt((1 - c) * (1 + c));
    const double x = radial > 0 ? axis.x / radial : 1.0;
    const double y = radial > 0 ? axis.y / radial : 0.0;
    const Vec3d right(x * c - y * s, y * c + x * s, 0);
    const Vec3d left(x * c + y * s, y * c - x * s, 0);
    const SphericalCap horizon{{0, 0, 1}, 0, 1};
    arcs_ = {BoundaryArc{cap, right, left, false}, BoundaryArc{horizon, left, right, false}};
    count_ = 2;
}

std::vector<BoundaryArc> polygon_boundary(const SphericalPolygon& polygon) {
    std::vector<BoundaryArc> arcs;
    const std::vector<Vec3d>& v = polygon.directions();
    for (std::size_t i = 0; i < v.size(); ++i) {
        const double length = glm::length(polygon.edge_cross(i));
        if (length > 0) {
            arcs.push_back({{polygon.edge_cross(i) / length, 0, 1}, v[i], v[(i + 1) % v.size()], false});
        }
    }
    return arcs;
}

}  // namespace shlight
