// SPDX-License-Identifier: MIT
//
// Polygons that stand for disks and ellipses where a lobe's boost is involved (docs/theory.md, 5.5).
//
// In the plane across the cone's axis the vertices lie a little outside the ellipse, so that each side, or pair of
// sides, leaves out as much as it adds. What is left of the difference is of fourth order in the length of a side. The
// vertices are spaced evenly in the parameter of spherical_ellipse.h, which a near rim does not crowd.
#pragma once

#include <vector>

#include "regions/spherical_ellipse.h"

namespace shlight {

/// Sizes are multiples of this, so that few of them occur.
inline constexpr int kDiskPolygonStep = 8;

/// How many vertices keep a coefficient within `tolerance` of L_00, 1e-5 … 1e-2, or the reflection of a lobe that
/// changes over `narrowest` [rad], and near the disk's middle over `near`; 0: of a mirror, whose image of the light is
/// then off by 1e-4 of its size. Precondition: not ellipse.empty().
int disk_polygon_size(const SphericalEllipse& ellipse, double narrowest, double near, double tolerance);

/// Appends `size` vertices, some of them repeated, of what is kept of the ellipse: planar, and not below the horizon if
/// that was clipped. Precondition: not ellipse.empty(); size: from disk_polygon_size.
void append_disk_polygon(const SphericalEllipse& ellipse, int size, std::vector<Vec3d>& vertices);

}  // namespace shlight
