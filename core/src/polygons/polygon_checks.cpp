// SPDX-License-Identifier: MIT
#include "polygons/polygon_checks.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "base/checks.h"

namespace shlight {
namespace {

/// What vertices may be off the mean plane, ÷ the polygon's extent.
constexpr double kGranted = 1e-4;

/// Of T, in the distance of a plane from the shading point: what the rounding of its vertices leaves open, and more.
constexpr double kInPlane = 8;

/// Squares: of the area, the extent, and the largest deviation from the mean plane × the area. normal: of the mean
/// plane, of any length.
struct Flatness {
    Vec3d normal;
    double area, extent, deviation;

    bool within(double granted) const { return deviation <= granted * granted * extent * area; }
    /// Of finite vertices, whose squares neither overflow nor vanish: a NaN or an infinity reaches the area.
    bool is_usual() const {
        const double product = area * extent;
        return product > std::numeric_limits<double>::min() && product < std::numeric_limits<double>::max();
    }
};

/// Of what steps from the first vertex tell.
template <class Step>
Flatness flatness_of(std::size_t count, const Step& step) {
    Vec3d area(0);
    Vec3d before = step(1);
    double extent = glm::dot(before, before);
    for (std::size_t i = 2; i < count; ++i) {
        const Vec3d next = step(i);
        area += glm::cross(before, next);
        extent = std::max(extent, glm::dot(next, next));
        before = next;
    }
    double deviation = 0;
    for (std::size_t i = 1; i < count; ++i) {
        deviation = std::max(deviation, std::abs(glm::dot(area, step(i))));
    }
    return {area, glm::dot(area, area), extent, deviation * deviation};
}

/// The mean plane of four vertices is parallel to both diagonals. The extent is one of them at least.
inline Flatness flatness_of_quad(const Vec3d* v) {
    const Vec3d diagonal = v[2] - v[0];
    const Vec3d area = glm::cross(diagonal, v[3] - v[1]);
    const double deviation = glm::dot(area, v[1] - v[0]);
    return {area, glm::dot(area, area), glm::dot(diagonal, diagonal), deviation * deviation};
}

/// Whether the rounding of a vertex to numbers of this epsilon decides on which side of the origin the plane is.
bool holds_origin(const Vec3d& normal, std::span<const Vec3d> v, double epsilon) {
    double rounded = 0;
    for (const Vec3d& p : v) {
        rounded = std::max(rounded, glm::dot(glm::abs(normal), glm::abs(p)));
    }
    return std::abs(glm::dot(normal, v[0])) <= kInPlane * epsilon * rounded;
}

/// Of a polygon in whose plane the origin lies: whether it is inside or on the outline, by the turns around it.
bool surrounds_origin(const Vec3d& normal, std::span<const Vec3d> v, double epsilon) {
    double angle = 0;
    for (std::size_t i = 0; i < v.size(); ++i) {
        const Vec3d& a = v[i];
        const Vec3d& b = v[(i + 1) % v.size()];
        const double sine = glm::dot(glm::cross(a, b), normal) / glm::length(normal);
        const double cosine = glm::dot(a, b);
        if (cosine <= 0 && std::abs(sine) <= kInPlane * epsilon * (glm::dot(a, a) + glm::dot(b, b))) {
            return true;
        }
        angle += std::atan2(sine, cosine);
    }
    return std::abs(angle) > 1;
}

/// True for nearly all polygons that are sound, and for no others.
bool is_surely_sound(std::span<const Vec3d> v, double epsilon) {
    const Flatness flatness =
        v.size() == 4 ? flatness_of_quad(v.data()) : flatness_of(v.size(), [&](std::size_t i) { return v[i] - v[0]; });
    return flatness.is_usual() && flatness.within(kGranted / 2) && !holds_origin(flatness.normal, v, epsilon);
}

void check_polygon(std::span<const Vec3d> vertices, double epsilon) {
    double largest = 0;
    double size = 0;
    for (const Vec3d& v : vertices) {
        check_finite("vertices", v);
        for (int i = 0; i < 3; ++i) {
            largest = std::max(largest, std::abs(v[i]));
            size = std::max(size, std::abs(v[i] / 2 - vertices[0][i] / 2));
        }
    }
    if (!(size > 0)) {
        return;
    }
    // In units of the polygon, in which nothing overflows.
    const Flatness flatness =
        flatness_of(vertices.size(), [&](std::size_t i) { return (vertices[i] / 2.0 - vertices[0] / 2.0) / size; });
    // A far polygon's vertices are off its plane by their own rounding.
    const double far = largest / (2 * size * std::sqrt(flatness.extent));
    if (!flatness.within(kGranted + 8 * epsilon * std::sqrt(3) * far)) {
        reject("vertices: a polygon is not planar");
    }
    std::vector<Vec3d> scaled;
    std::transform(vertices.begin(), vertices.end(), std::back_inserter(scaled),
                   [largest](const Vec3d& v) { return v / largest; });
    if (flatness.area > 0 && holds_origin(flatness.normal, scaled, epsilon) &&
        surrounds_origin(flatness.normal, scaled, epsilon)) {
        reject("vertices: the shading point lies inside a polygon");
    }
}

}  // namespace

void check_vertex_count(int vertex_count) {
    if (vertex_count < 3) {
        reject("vertices: a polygon needs at least 3, got " + std::to_string(vertex_count));
    }
}

template <class T>
void check_polygons(std::span<const Vec3d> vertices, int vertex_count) {
    const auto k = static_cast<std::size_t>(vertex_count);
    for (std::size_t first = 0; first < vertices.size(); first += k) {
        const auto polygon = vertices.subspan(first, k);
        if (!is_surely_sound(polygon, std::numeric_limits<T>::epsilon())) {
            check_polygon(polygon, std::numeric_limits<T>::epsilon());
        }
    }
}

template void check_polygons<float>(std::span<const Vec3d>, int);
template void check_polygons<double>(std::span<const Vec3d>, int);

}  // namespace shlight
