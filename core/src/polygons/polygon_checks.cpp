// SPDX-License-Identifier: MIT
#include "polygons/polygon_checks.h"

#include <algorithm>
#include <limits>
#include <string>

#include "base/checks.h"
#include "polygons/polygon_views.h"
#include "polygons/spherical_polygon.h"

namespace shlight {
namespace {

void check_each(std::span<const Vec3d> vertices, int vertex_count) {
    const auto k = static_cast<std::size_t>(vertex_count);
    for (std::size_t first = 0; first < vertices.size(); first += k) {
        check_polygon<float>(vertices.subspan(first, k));
    }
}

}  // namespace

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

template void check_polygon<float>(std::span<const Vec3d>);
template void check_polygon<double>(std::span<const Vec3<long double>>);

}  // namespace shlight
