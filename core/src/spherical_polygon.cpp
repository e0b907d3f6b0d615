// SPDX-License-Identifier: MIT
#include "spherical_polygon.h"

#include <algorithm>
#include <cmath>

namespace shlight {
namespace {

/// Twice the vector area; from differences, so that a far polygon keeps its digits.
Vec3d vector_area(std::span<const Vec3d> v) {
    Vec3d sum(0);
    for (std::size_t i = 1; i + 1 < v.size(); ++i) {
        sum += glm::cross(v[i] - v[0], v[i + 1] - v[0]);
    }
    return sum;
}

double extent(std::span<const Vec3d> v) {
    double largest = 0;
    for (const Vec3d& p : v) {
        largest = std::max(largest, glm::length(p - v[0]));
    }
    return largest;
}

/// Sutherland–Hodgman against z ≥ 0. Cut points get z = 0 exactly: their edge then lies *in* the horizon.
std::vector<Vec3d> clipped_by_horizon(std::span<const Vec3d> v) {
    std::vector<Vec3d> kept;
    kept.reserve(2 * v.size());
    for (std::size_t i = 0; i < v.size(); ++i) {
        const Vec3d& a = v[i];
        const Vec3d& b = v[(i + 1) % v.size()];
        if (a.z >= 0) {
            kept.push_back(a);
        }
        if ((a.z >= 0) != (b.z >= 0) && a.z != 0 && b.z != 0) {
            const double t = a.z / (a.z - b.z);
            kept.push_back({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), 0.0});
        }
    }
    return kept;
}

/// Solid angle of a triangle (Van Oosterom & Strackee 1983), signed by its winding. The triple product is taken of edge
/// vectors, so that its error is relative to the triangle and not to the sphere.
double triangle_solid_angle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const double la = glm::length(a);
    const double lb = glm::length(b);
    const double lc = glm::length(c);
    const double triple = glm::dot(a, glm::cross(b - a, c - a));
    const double denominator = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
    return 2 * std::atan2(triple, denominator);
}

}  // namespace

SphericalPolygon::SphericalPolygon(std::span<const Vec3d> vertices, bool clip) {
    std::vector<Vec3d> v = clip ? clipped_by_horizon(vertices) : std::vector<Vec3d>(vertices.begin(), vertices.end());
    if (v.size() < 3) {
        return;
    }
    // The plane and its distance from the origin come from the vertices as given: clipping would only add rounding.
    const Vec3d normal = vector_area(vertices);
    double farthest = 0;
    double distance = 0;
    for (const Vec3d& p : vertices) {
        farthest = std::max(farthest, glm::length(p));
        distance += glm::dot(normal, p) / static_cast<double>(vertices.size());
    }
    constexpr double kEdgeOn = 1e-14;
    if (!(std::abs(distance) > kEdgeOn * farthest * glm::length(normal))) {
        return;
    }
    if (distance < 0) {
        std::reverse(v.begin(), v.end());
    }
    for (std::size_t i = 1; i + 1 < v.size(); ++i) {
        solid_angle_ += triangle_solid_angle(v[0], v[i], v[i + 1]);
    }
    if (!(solid_angle_ > 0)) {
        solid_angle_ = 0;
        return;
    }
    for (std::size_t i = 0; i < v.size(); ++i) {
        const Vec3d& a = v[i];
        const Vec3d& b = v[(i + 1) % v.size()];
        directions_.push_back(a / glm::length(a));
        edge_crosses_.push_back(glm::cross(a, b - a) / (glm::length(a) * glm::length(b)));
    }
}

double planarity_error(std::span<const Vec3d> vertices) {
    const Vec3d area = vector_area(vertices);
    const double size = extent(vertices);
    const double length = glm::length(area);
    if (!(length > 0)) {
        return 0;
    }
    double largest = 0;
    for (const Vec3d& p : vertices) {
        largest = std::max(largest, std::abs(glm::dot(area, p - vertices[0])) / length);
    }
    return largest / size;
}

}  // namespace shlight
