// SPDX-License-Identifier: MIT
//
// A planar polygon as seen from the origin: clipped, turned into directions, measured.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "shlight/types.h"

namespace shlight {

/// A plane is seen edge-on if its distance from the origin is at most this part of that of its farthest point.
inline constexpr double kEdgeOn = 64 * std::numeric_limits<double>::epsilon();
/// Nearer than this part of it, the corners of a sliver in float may be off its plane by as much as the origin is.
inline constexpr double kRounded = 4 * std::numeric_limits<float>::epsilon();

/// Distance of the origin from the polygon's plane times twice its area, positive if the vertices are seen
/// counter-clockwise from the origin's antipode, that is with the interior on the left of each edge; 0 if edge-on.
double plane_side(std::span<const Vec3d> vertices);

class SphericalPolygon {
  public:
    /// vertices: k ≥ 3, planar, in either winding. clip: keep only z ≥ 0.
    SphericalPolygon(std::span<const Vec3d> vertices, bool clip);

    /// Nothing is left: no area, edge-on, or below the horizon.
    bool empty() const { return directions_.empty(); }
    /// Unit vectors to the vertices, the interior on the left of each edge seen from outside the sphere.
    const std::vector<Vec3d>& directions() const { return directions_; }
    /// a × b / (|a| |b|) of the edge from vertex i to the next: the edge's pole times the sine of its length.
    const Vec3d& edge_cross(std::size_t i) const { return edge_crosses_[i]; }
    double solid_angle() const { return solid_angle_; }

  private:
    std::vector<Vec3d> directions_;
    std::vector<Vec3d> edge_crosses_;
    double solid_angle_ = 0;
};

/// Sutherland–Hodgman against z ≥ 0. Points where edges are cut get z = 0 exactly: the edge between two of them then
/// lies in the horizon. What is left of a polygon that touches z ≥ 0 nowhere is empty.
std::vector<Vec3d> clipped_by_horizon(std::span<const Vec3d> v);

/// Solid angle of a triangle (Van Oosterom & Strackee 1983), signed by its winding. The triple product is taken of edge
/// vectors, so that its error is relative to the triangle and not to the sphere.
double triangle_solid_angle(const Vec3d& a, const Vec3d& b, const Vec3d& c);

}  // namespace shlight
