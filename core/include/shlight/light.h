// SPDX-License-Identifier: MIT
//
// Area lights of uniform radiance, in the world frame.
#pragma once

#include <variant>
#include <vector>

#include "shlight/ray_tracer.h"
#include "shlight/types.h"

namespace shlight {

/// A sphere, or a disk that always faces the shading point: caps of half angle asin(R/d) and atan(R/d).
struct SphereLight {
    Vec3d center;
    double radius;
    Rgb radiance;
    bool facing_disk;
};

/// A planar polygon. One-sided ones shine to the side that sees the vertices counter-clockwise.
struct PolygonLight {
    std::vector<Vec3d> vertices;
    std::vector<Triangle> triangles;  ///< triangulation, wound as the vertices are
    Vec3d normal;                     ///< unit, towards the side that sees the vertices counter-clockwise
    Rgb radiance;
    bool two_sided;
    Vec3d center;   ///< mean of the vertices
    double radius;  ///< largest distance of a vertex from it
    double error;   ///< bound of the distance between this plane and a mesh face that float rays meet in its place
};

using Light = std::variant<SphereLight, PolygonLight>;

/// Throws std::invalid_argument naming the argument: a number that is not finite, a radius ≤ 0.
/// Radiance may be negative: such a light takes light away.
SphereLight make_sphere_light(const Vec3d& center, double radius, const Rgb& radiance, bool facing_disk);

/// vertices: k ≥ 3 of a simple polygon, convex or not; repeated vertices are merged, and vertices off the polygon's
/// plane by less than 1e-4 of its extent are moved onto it.
/// Throws std::invalid_argument naming the argument: fewer than three vertices, a number that is not finite, vertices
/// that are not planar, enclose no area or cross themselves.
PolygonLight make_polygon_light(std::vector<Vec3d> vertices, const Rgb& radiance, bool two_sided);

}  // namespace shlight
