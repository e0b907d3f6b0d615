// SPDX-License-Identifier: MIT
#include "regions/region_checks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "base/checks.h"
#include "base/exact_sums.h"
#include "base/ray_rounding.h"
#include "base/safe_length.h"
#include "regions/cap_arrays.h"
#include "regions/spherical_ellipse.h"

namespace shlight {
namespace {

/// Width ÷ length of an ellipse whose coefficients are right to 1e-10 in float64.
constexpr double kNarrowestEllipse = 1e-9;

/// Granted distance of vertices from the mean plane, ÷ the polygon's extent.
constexpr double kGranted = 1e-4;

/// Epsilons of T: what the rounding of vertices and a step or two before it leave open.
constexpr double kInPlane = 8;

/// Area ÷ square of the extent at which a polygon is a line, to rounding.
constexpr double kNoArea = 16 * std::numeric_limits<double>::epsilon();

/// Square of the least distance whose third power stays within doubles.
constexpr double kLeastSquare = 1e-60;

/// Squares: of the area, the extent, and the largest deviation from the mean plane × the area. normal: of the mean
/// plane, of any length.
struct Flatness {
    Vec3d normal;
    double area, extent, deviation;

    bool within(double granted) const { return deviation <= granted * granted * extent * area; }
    /// The vertices are finite and their squares neither overflow nor vanish: a NaN or an infinity reaches the area.
    bool is_usual() const {
        const double product = area * extent;
        return product > std::numeric_limits<double>::min() && product < std::numeric_limits<double>::max();
    }
    bool is_line(double granted) const { return area <= granted * granted * extent * extent; }
};

/// The flatness of a polygon from the steps from its first vertex to the others.
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

/// Whether more than the rounding of three vertices to numbers of this epsilon decides on which side of their plane the
/// origin is. An edge that all but touches the origin decides it, however far the third vertex.
bool is_decided(const Vec3d& a, const Vec3d& b, const Vec3d& c, double epsilon) {
    const auto products = [](const Vec3d& p, const Vec3d& q) {
        return Vec3d(p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x);
    };
    const double rounded = glm::dot(products(glm::abs(a), glm::abs(b)), glm::abs(c));
    return std::abs(glm::dot(glm::cross(a, b), c)) > kInPlane * epsilon * rounded;
}

/// Whether a polygon in a plane with this normal is seen edge-on.
bool is_edge_on(const Vec3d& normal, std::span<const Vec3d> v, double epsilon) {
    double farthest = 0;
    bool decided = false;
    for (std::size_t i = 0; i < v.size(); ++i) {
        farthest = std::max(farthest, glm::length(v[i]));
        decided = decided || is_decided(v[i], v[(i + 1) % v.size()], v[(i + 2) % v.size()], epsilon);
    }
    return !decided || std::abs(glm::dot(normal, v[0])) <= kEdgeOn * farthest * glm::length(normal);
}

/// True for all that is_edge_on, for those with a vertex at the origin, for those of unusual units, and for some
/// others.
bool may_be_edge_on(const Vec3d& normal, std::span<const Vec3d> v, double epsilon) {
    double farthest = 0, nearest = std::numeric_limits<double>::max();
    for (const Vec3d& p : v) {
        const double square = glm::dot(p, p);
        farthest = std::max(farthest, square);
        nearest = std::min(nearest, square);
    }
    if (!(nearest > 0 && farthest > kLeastSquare && farthest < 1 / kLeastSquare)) {
        return true;
    }
    const double granted = 2 * std::max(kInPlane * epsilon, kEdgeOn);
    const double distance = glm::dot(normal, v[0]);
    return distance * distance <= granted * granted * farthest * glm::dot(normal, normal);
}

/// How a polygon in whose plane the origin lies goes around it.
struct Turns {
    bool touch = false;             ///< the origin is on the boundary
    double sum = 0;                 ///< sum of the angles of the edges [rad]
    double least = 0, largest = 0;  ///< extreme partial sums
};

Turns turns_around_origin(const Vec3d& normal, std::span<const Vec3d> v, double epsilon) {
    Turns turns;
    for (std::size_t i = 0; i < v.size(); ++i) {
        const Vec3d& a = v[i];
        const Vec3d& b = v[(i + 1) % v.size()];
        const double sine = glm::dot(glm::cross(a, b), normal) / glm::length(normal);
        const double cosine = glm::dot(a, b);
        turns.touch =
            turns.touch || (cosine <= 0 && std::abs(sine) <= kInPlane * epsilon * (glm::dot(a, a) + glm::dot(b, b)));
        turns.sum += std::atan2(sine, cosine);
        turns.least = std::min(turns.least, turns.sum);
        turns.largest = std::max(turns.largest, turns.sum);
    }
    return turns;
}

/// True for nearly all polygons that are sound, and for no others.
bool is_surely_sound(std::span<const Vec3d> v, double epsilon) {
    const Flatness flatness =
        v.size() == 4 ? flatness_of_quad(v.data()) : flatness_of(v.size(), [&](std::size_t i) { return v[i] - v[0]; });
    return flatness.is_usual() && !flatness.is_line(4 * kNoArea) && flatness.within(kGranted / 2) &&
           !may_be_edge_on(flatness.normal, v, epsilon);
}

/// The unit of the largest coordinate; false if all are 0.
bool take_own_unit(std::span<Vec3d> vertices) {
    double largest = 0;
    for (const Vec3d& v : vertices) {
        check_finite("vertices", v);
        largest = std::max(largest, largest_component(v));
    }
    if (largest == 0) {
        return false;
    }
    const double scale = power_of_two_scale(largest);
    for (Vec3d& v : vertices) {
        v *= scale;
    }
    return true;
}

/// Checks a polygon in its own unit, and leaves it without light where rounding decides what is seen.
void prepare_polygon(std::span<Vec3d> vertices, double epsilon) {
    if (!take_own_unit(vertices)) {
        return;
    }
    double size = 0;
    for (const Vec3d& v : vertices) {
        size = std::max(size, largest_component(v - vertices[0]));
    }
    if (size == 0) {
        return;
    }
    const Flatness flatness =
        flatness_of(vertices.size(), [&](std::size_t i) { return (vertices[i] - vertices[0]) / size; });
    if (flatness.is_line(kNoArea)) {
        std::fill(vertices.begin(), vertices.end(), vertices[0]);
        return;
    }
    // A far polygon's vertices are off its plane by their own rounding.
    const double far = 2 / (size * std::sqrt(flatness.extent));
    if (vertices.size() > 3 && !flatness.within(kGranted + 8 * epsilon * std::sqrt(3) * far)) {
        reject("vertices: a polygon is not planar");
    }
    // A vertex may be off the plane that the others are in, and at the origin where they are not edge-on.
    if (std::find(vertices.begin(), vertices.end(), Vec3d(0)) != vertices.end()) {
        reject("vertices: the shading point lies inside a polygon");
    }
    // Three vertices decide nothing where two of them are equal, and the plane may still do so.
    if (may_be_edge_on(flatness.normal, vertices, epsilon) && is_edge_on(flatness.normal, vertices, epsilon)) {
        const Turns turns = turns_around_origin(flatness.normal, vertices, epsilon);
        if (turns.touch || std::abs(turns.sum) > 1) {
            reject("vertices: the shading point lies inside a polygon");
        }
        if (turns.largest - turns.least > 3) {
            std::fill(vertices.begin(), vertices.end(), vertices[0]);
        }
    }
    if (vertices.size() == 3) {
        // Only directions count, and floats could not hold the products of a far vertex and of near ones.
        for (Vec3d& v : vertices) {
            v *= power_of_two_scale(largest_component(v));
        }
    }
}

}  // namespace

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

void check_vertex_count(int vertex_count) {
    if (vertex_count < 3) {
        reject("vertices: a polygon needs at least 3, got " + std::to_string(vertex_count));
    }
}

template <class T>
void prepare_polygons(std::span<Vec3d> vertices, int vertex_count) {
    const auto k = static_cast<std::size_t>(vertex_count);
    for (std::size_t first = 0; first < vertices.size(); first += k) {
        const auto polygon = vertices.subspan(first, k);
        if (!is_surely_sound(polygon, std::numeric_limits<T>::epsilon())) {
            prepare_polygon(polygon, std::numeric_limits<T>::epsilon());
        }
    }
}

template void prepare_polygons<float>(std::span<Vec3d>, int);
template void prepare_polygons<double>(std::span<Vec3d>, int);

void check_disk(const Ellipse& disk, double epsilon) {
    check_finite("centers", disk.center);
    check_finite("half_axes_u", disk.half_axis_u);
    check_finite("half_axes_v", disk.half_axis_v);
    const Vec3d& u = disk.half_axis_u;
    const Vec3d& v = disk.half_axis_v;
    if (u == Vec3d(0)) {
        reject("half_axes_u contains a zero vector");
    }
    const double longest = std::max(safe_length(u), safe_length(v));
    if (!(glm::length(glm::cross(u / safe_length(u), v / safe_length(v))) > 4 * epsilon)) {
        reject("half_axes_v: a disk's half axes are dependent");
    }
    if (!(glm::length(glm::cross(u / longest, v / longest)) > kNarrowestEllipse)) {
        reject("half_axes_v: an ellipse may be 1e9 times as long as it is wide, at most");
    }
    if (place_of_origin(disk) == OriginPlace::in_plane_inside) {
        reject("centers: the shading point lies inside a disk");
    }
}

}  // namespace shlight
