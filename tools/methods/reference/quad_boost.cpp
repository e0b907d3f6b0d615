// SPDX-License-Identifier: MIT
#include "quad_boost.h"

#include <array>

#include "quad_cap.h"

namespace shlight::truth {
namespace {

struct Disk {
    Vec3q axis;
    quad half;
};

/// The disk whose edge passes through three points and which contains a fourth.
Disk disk_through(const std::array<Vec3q, 3>& edge, const Vec3q& inside) {
    Vec3q axis = normalized(cross(edge[1] - edge[0], edge[2] - edge[0]));
    if (dot(axis, inside - edge[0]) < 0) {
        axis = quad(-1) * axis;
    }
    return {axis, atan2f128(length(cross(axis, edge[0])), dot(axis, edge[0]))};
}

/// The image of the disk of this half angle about `axis`.
Disk image(const PointwiseBoost& boost, const Vec3q& axis, quad half) {
    const Vec3q pole = normalized(axis);
    const Vec3q other = fabsf128(pole.x) < 0.5 ? Vec3q{1, 0, 0} : Vec3q{0, 0, 1};
    const Vec3q u = normalized(cross(pole, other));
    const Vec3q v = cross(pole, u);
    std::array<Vec3q, 3> edge;
    for (int i = 0; i < 3; ++i) {
        const quad psi = quad(1) / 10 + 2 * i * pi() / 3;
        const Vec3q point = cosf128(half) * pole + sinf128(half) * (cosf128(psi) * u + sinf128(psi) * v);
        edge[static_cast<std::size_t>(i)] = boost.image(point).point;
    }
    return disk_through(edge, boost.image(pole).point);
}

}  // namespace

Coefficients boosted_cap(const CapInput& input, const BoostInput& boost, int order, int extra_nodes) {
    const PointwiseBoost map(boost);
    const Disk light = image(map, quad_vector(input.axis), half_angle(input));
    const Disk above = image(map, {0, 0, 1}, pi() / 2);
    return cap_above(cap_angles(light.axis, light.half), above.half, order, extra_nodes);
}

}  // namespace shlight::truth
