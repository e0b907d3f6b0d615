// SPDX-License-Identifier: MIT
#include "disks/disk_checks.h"

#include <limits>

#include "base/checks.h"
#include "disks/spherical_ellipse.h"

namespace shlight {

template <class T>
void check_disk(const Ellipse<Wider<T>>& disk) {
    using Real = Wider<T>;
    check_finite("centers", disk.center);
    check_finite("half_axes_u", disk.half_axis_u);
    check_finite("half_axes_v", disk.half_axis_v);
    const Vec3<Real>& u = disk.half_axis_u;
    const Vec3<Real>& v = disk.half_axis_v;
    if (u == Vec3<Real>(0)) {
        reject("half_axes_u contains a zero vector");
    }
    const Vec3<Real> a = u / glm::length(u);
    const Vec3<Real> b = v / glm::length(v);
    constexpr Real kEpsilon = std::numeric_limits<T>::epsilon();
    if (!(glm::length(glm::cross(a, b)) > 4 * kEpsilon)) {
        reject("half_axes_v: a disk's half axes are dependent");
    }
    if (place_of_origin(disk) == OriginPlace::in_plane_inside) {
        reject("centers: the shading point lies inside a disk");
    }
}

template void check_disk<float>(const Ellipse<double>&);
template void check_disk<double>(const Ellipse<long double>&);

}  // namespace shlight
