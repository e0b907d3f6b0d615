// SPDX-License-Identifier: MIT
#include "regions/spherical_polygon.h"

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

}  // namespace

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
            kept.emplace_back(a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), 0.0);
        }
    }
    return kept;
}

namespace {

/// The side from a to b is the longest. Where it is nearly half a turn, a·(b×c) and 1 + a·b + b·c + c·a of the unit
/// vectors both vanish as the square of a + b: they are formed from that sum and from c's distance to its neighbour b
/// or a. The sum, in turn, lies across the chord b - a in their plane, where a×(b-a) has every digit.
double solid_angle_with_long_side(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const double la = glm::length(a);
    const double lb = glm::length(b);
    const Vec3d chord = b / lb - a / la;
    const Vec3d sum = glm::cross(chord, glm::cross(a, b - a)) * (2 / (la * lb * glm::dot(chord, chord)));
    const Vec3d end = c / glm::length(c);
    const bool near_b = glm::dot(chord, c) > 0;
    const Vec3d neighbour = near_b ? b / lb : a / la;
    const Vec3d step = end - neighbour;
    const double triple = glm::dot(sum, glm::cross(neighbour, step));
    return 2 * std::atan2(near_b ? triple : -triple, glm::dot(sum, sum + step));
}

}  // namespace

double triangle_solid_angle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const double la = glm::length(a);
    const double lb = glm::length(b);
    const double lc = glm::length(c);
    const double ab = glm::dot(a, b) * lc;
    const double bc = glm::dot(b, c) * la;
    const double ca = glm::dot(c, a) * lb;
    const double product = la * lb * lc;
    const double least = std::min({ab, bc, ca});
    if (least < -product / 2) {
        return least == ab   ? solid_angle_with_long_side(a, b, c)
               : least == bc ? solid_angle_with_long_side(b, c, a)
                             : solid_angle_with_long_side(c, a, b);
    }
    const double triple = glm::dot(a, glm::cross(b - a, c - a));
    return 2 * std::atan2(triple, product + ab + bc + ca);
}

double plane_side(std::span<const Vec3d> vertices) {
    const Vec3d normal = vector_area(vertices);
    double farthest = 0;
    double distance = 0;
    for (const Vec3d& p : vertices) {
        farthest = std::max(farthest, glm::dot(p, p));
        distance += glm::dot(normal, p);
    }
    farthest = std::sqrt(farthest);
    distance /= static_cast<double>(vertices.size());
    return std::abs(distance) > kEdgeOn * farthest * glm::length(normal) ? distance : 0;
}

SphericalPolygon::SphericalPolygon(std::span<const Vec3d> vertices, bool clip) {
    std::vector<Vec3d> kept;
    std::span<const Vec3d> v = vertices;
    if (clip && std::any_of(v.begin(), v.end(), [](const Vec3d& p) { return !(p.z >= 0); })) {
        kept = clipped_by_horizon(vertices);
        v = kept;
    }
    if (v.size() < 3) {
        return;
    }
    // The plane's side comes from the vertices as given: clipping would only add rounding.
    const double side = plane_side(vertices);
    if (side == 0) {
        return;
    }
    const std::size_t count = v.size();
    const auto vertex = [&](std::size_t i) -> const Vec3d& { return v[side < 0 ? count - 1 - i : i]; };
    for (std::size_t i = 1; i + 1 < count; ++i) {
        solid_angle_ += triangle_solid_angle(vertex(0), vertex(i), vertex(i + 1));
    }
    if (!(solid_angle_ > 0)) {
        solid_angle_ = 0;
        return;
    }
    directions_.reserve(count);
    edge_crosses_.reserve(count);
    double over_length = 1 / glm::length(vertex(0));
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3d& a = vertex(i);
        const Vec3d& b = vertex(i + 1 < count ? i + 1 : 0);
        const double over_next = 1 / glm::length(b);
        directions_.push_back(a * over_length);
        edge_crosses_.push_back(glm::cross(a, b - a) * (over_length * over_next));
        over_length = over_next;
    }
}

}  // namespace shlight
