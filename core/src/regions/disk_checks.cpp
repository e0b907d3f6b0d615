// SPDX-License-Identifier: MIT
#include "regions/disk_checks.h"

#include <algorithm>
#include <limits>

#include "base/checks.h"
#include "regions/spherical_ellipse.h"

namespace shlight {

namespace {

/// Width ÷ length of an ellipse whose coefficients are right to 1e-10 in float64.
constexpr double kNarrowest = 1e-9;

}  // namespace

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
    const Real longest = std::max(glm::length(u), glm::length(v));
    if (!(glm::length(glm::cross(u / longest, v / longest)) > kNarrowest)) {
        reject("half_axes_v: an ellipse may be 1e9 times as long as it is wide, at most");
    }
    if (place_of_origin(disk) == OriginPlace::in_plane_inside) {
        reject("centers: the shading point lies inside a disk");
    }
}

template void check_disk<float>(const Ellipse<double>&);
template void check_disk<double>(const Ellipse<long double>&);

}  // namespace shlight
