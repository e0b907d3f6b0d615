// SPDX-License-Identifier: MIT
//
// References for polygons under a boost, in 113 bits. The boost is taken point by point, as a stretch of the
// stereographic plane; no image of a circle enters.
#pragma once

#include <span>

#include "quad_truth.h"

namespace shlight::truth {

/// order² coefficients of the image of a polygon that is clipped by the horizon: the slices of quad_truth.h, summed
/// along the image of each edge.
Coefficients boosted_polygon(std::span<const Vec3d> vertices, const BoostInput& boost, int order, int extra_nodes = 0);

/// The same by product Gauss cubature of Y(u(ω)) du/dω over the polygon itself, with nodes² points on each triangle of
/// a fan, to check `boosted_polygon`.
Coefficients boosted_polygon_by_cubature(std::span<const Vec3d> vertices, const BoostInput& boost, int order,
                                         int nodes);

}  // namespace shlight::truth
