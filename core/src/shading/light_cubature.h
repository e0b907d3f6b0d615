// SPDX-License-Identifier: MIT
//
// A lobe integrated over a light that is small beside it: a few values of the true f·cos.
#pragma once

#include "polygons/spherical_polygon.h"
#include "shlight/lobe_shape.h"
#include "shlight/types.h"
#include "shlight/warp.h"

namespace shlight {

struct CubatureSum {
    double value;
    int points;
};

/// ∫ f·cos over a cap that lies above the horizon, by a rule of cubature_kernel.h.
CubatureSum cap_cubature(const LobeShape& shape, const Vec3d& view, const Circle& cap, int rule_number);
/// ∫ f·cos over a polygon clipped by the horizon, by a rule of 3, 7, 16 or 25 points a triangle.
CubatureSum polygon_cubature(const LobeShape& shape, const Vec3d& view, const SphericalPolygon& polygon,
                             int rule_number);

}  // namespace shlight
