// SPDX-License-Identifier: MIT
//
// What is to be known of many polygons before they are integrated.
#pragma once

#include <span>

#include "shlight/types.h"

namespace shlight {

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
