// SPDX-License-Identifier: MIT
#include <array>

#include "quad_cap.h"

namespace shlight::truth {
namespace {

/// The warp point by point: the stereographic projection from -axis is scaled by (1 + r) / (1 - r). In the frame
/// whose third axis is (-sin tilt, 0, cos tilt), y kept.
class PointMap {
  public:
    PointMap(double tilt, double narrowness)
        : cos_(cosf128(tilt)), sin_(sinf128(tilt)), scale_((2 - quad(narrowness)) / narrowness) {}

    Vec3q operator()(const Vec3q& w) const {
        const Vec3q local{cos_ * w.x + sin_ * w.z, w.y, cos_ * w.z - sin_ * w.x};
        const quad across = local.x * local.x + local.y * local.y;
        if (across == 0) {
            return local;
        }
        // tan(α/2) from the side where nothing cancels; tan(α'/2) = scale · tan(α/2).
        const quad half_tangent = local.z > 0 ? sqrtf128(across) / (1 + local.z) : (1 - local.z) / sqrtf128(across);
        const quad t = scale_ * half_tangent;
        const quad stretch = 2 * t / (1 + t * t) / sqrtf128(across);
        return {stretch * local.x, stretch * local.y, (1 - t * t) / (1 + t * t)};
    }

  private:
    quad cos_, sin_, scale_;
};

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
Disk image(const PointMap& map, const Vec3q& axis, quad half) {
    const Vec3q pole = normalized(axis);
    const Vec3q other = fabsf128(pole.x) < 0.5 ? Vec3q{1, 0, 0} : Vec3q{0, 0, 1};
    const Vec3q u = normalized(cross(pole, other));
    const Vec3q v = cross(pole, u);
    std::array<Vec3q, 3> edge;
    for (int i = 0; i < 3; ++i) {
        const quad psi = quad(1) / 10 + 2 * i * pi() / 3;
        edge[static_cast<std::size_t>(i)] =
            map(cosf128(half) * pole + sinf128(half) * (cosf128(psi) * u + sinf128(psi) * v));
    }
    return disk_through(edge, map(pole));
}

}  // namespace

Coefficients warped_cap(const CapInput& input, double tilt, double narrowness, int order, int extra_nodes) {
    const PointMap map(tilt, narrowness);
    const Disk light = image(map, quad_vector(input.axis), half_angle(input));
    const Disk above = image(map, {0, 0, 1}, pi() / 2);
    // z along the middle of the horizon's image; both lie in the plane y = 0.
    const Vec3q z = above.axis;
    const Vec3q axis{z.z * light.axis.x - z.x * light.axis.z, light.axis.y, dot(z, light.axis)};
    return cap_above(cap_angles(axis, light.half), above.half, order, extra_nodes);
}

}  // namespace shlight::truth
