// SPDX-License-Identifier: MIT
#include "light_checks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "checks.h"
#include "exact_sums.h"
#include "kernels/cap_kernel.h"
#include "kernels/polygon_views.h"
#include "spherical_ellipse.h"

namespace shlight {
namespace {

void check_each(std::span<const Vec3d> vertices, int vertex_count) {
    const auto k = static_cast<std::size_t>(vertex_count);
    for (std::size_t first = 0; first < vertices.size(); first += k) {
        check_polygon<float>(vertices.subspan(first, k));
    }
}

}  // namespace

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
    if (!spheres_are_sound(centers.data(), radii.data(), centers.size())) {
        for (std::size_t i = 0; i < centers.size(); ++i) {
            check_sphere(Vec3d(centers[i]), static_cast<double>(radii[i]), epsilon);
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

void check_vertex_count(int vertex_count) {
    if (vertex_count < 3) {
        reject("vertices: a polygon needs at least 3, got " + std::to_string(vertex_count));
    }
}

template <class T>
void check_polygon(std::span<const Vec3<Wider<T>>> vertices) {
    using Real = Wider<T>;
    Real largest = 0;
    Real extent = 0;
    for (const Vec3<Real>& v : vertices) {
        check_finite("vertices", v);
        largest = std::max(largest, glm::length(v));
        extent = std::max(extent, glm::length(v - vertices[0]));
    }
    // A far polygon's vertices are off its plane by their own rounding.
    constexpr Real kEpsilon = std::numeric_limits<T>::epsilon();
    if (extent > 0 && planarity_error(vertices) > Real(1e-4) + 8 * kEpsilon * largest / extent) {
        reject("vertices: a polygon is not planar");
    }
}

void check_polygons(std::span<const Vec3d> vertices, int vertex_count) {
    if (!polygons_are_sound(vertices, vertex_count)) {
        check_each(vertices, vertex_count);
    }
}

void check_polygons(std::span<const Vec3f> given, std::span<const Vec3d> vertices, int vertex_count) {
    if (!polygons_are_sound(given, vertices, vertex_count)) {
        check_each(vertices, vertex_count);
    }
}

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

template void check_spheres(std::span<const Vec3<float>>, std::span<const float>, double);
template void check_spheres(std::span<const Vec3<double>>, std::span<const double>, double);
template void check_polygon<float>(std::span<const Vec3d>);
template void check_polygon<double>(std::span<const Vec3<long double>>);
template void check_disk<float>(const Ellipse<double>&);
template void check_disk<double>(const Ellipse<long double>&);

}  // namespace shlight
