// SPDX-License-Identifier: MIT
//
// What is to be known of many polygons before they are integrated.
#pragma once

#include <span>

#include "shlight/types.h"

namespace shlight {

/// Whether all polygons are finite and planar as check_polygon<float> has it; if not, that function tells which is not
/// and why. Says no too for coordinates whose squares overflow: then each is worth a look.
bool polygons_are_sound(std::span<const Vec3d> vertices, int vertex_count);

/// The same of polygons that were given in float, in which most are told to be sound; vertices: their numbers in
/// double.
bool polygons_are_sound(std::span<const Vec3f> given, std::span<const Vec3d> vertices, int vertex_count);

/// Polygons as directions, and their half angles: negative where nothing is seen.
struct PolygonArrays {
    const double *x, *y, *z;
    const double* half_angle;
};

/// One for each polygon.
struct PolygonExtents {
    std::span<double> x, y, z;     ///< a unit vector in the middle of the vertices that the horizon leaves
    std::span<double> half_angle;  ///< the longest chord from there to one of them; negative if nothing is seen
};

/// The polygons as directions above the horizon. Nothing is seen of one that lies below it, is seen edge-on or has no
/// area.
void polygon_extents(std::span<const Vec3d> vertices, int vertex_count, const PolygonExtents& extents);

}  // namespace shlight
