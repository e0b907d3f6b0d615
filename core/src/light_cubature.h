// SPDX-License-Identifier: MIT
//
// A lobe integrated over a light that is small beside it: a few values of the true f·cos.
#pragma once

#include "shlight/lobe_shape.h"
#include "shlight/types.h"
#include "shlight/warp.h"
#include "spherical_polygon.h"

namespace shlight {

/// How large a light looks to a lobe: its half angle [rad] over the least distance on which f·cos changes near its
/// middle. middle: unit direction; a bound from above. Precondition: shape.alpha > 0.
double relative_size(const GgxShape& shape, const Vec3d& view, const Vec3d& middle, double half_angle);

/// The smallest rule for polygons whose error, of a light of this relative size, is at most `tolerance`, absolute in
/// units of the lobe's albedo and relative to the light's own value; 0 if the light is too large for any.
/// 3, 7, 16, 25 points a triangle.
int polygon_rule_number(double relative_size, double tolerance);

struct CubatureSum {
    double value;
    int points;
};

/// ∫ f·cos over a cap that lies above the horizon, by a rule of cap_cubature_kernel.h.
CubatureSum cap_cubature(const GgxShape& shape, const Vec3d& view, const Circle& cap, int rule_number);
/// ∫ f·cos over a polygon clipped by the horizon.
CubatureSum polygon_cubature(const GgxShape& shape, const Vec3d& view, const SphericalPolygon<double>& polygon,
                             int rule_number);

}  // namespace shlight
