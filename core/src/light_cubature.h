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

/// The smallest rule of a kind whose error, of a light of this relative size, is ≤ tolerance, absolute in units of the
/// lobe's albedo, and a few times the tolerance relative to the light's own value; 0 if the light is too large.
/// cap_rings: rings of points, 2k + 2 on ring number k of the rule with k rings; one ring of one point is the middle.
int cap_rings(double relative_size, double tolerance);
int polygon_points(double relative_size, double tolerance);

struct CubatureSum {
    double value;
    int points;
};

/// ∫ f·cos over a cap that lies above the horizon. rings: of cap_rings.
CubatureSum cap_cubature(const GgxShape& shape, const Vec3d& view, const Circle& cap, int rings);
/// ∫ f·cos over a polygon clipped by the horizon. points: along a triangle's side.
CubatureSum polygon_cubature(const GgxShape& shape, const Vec3d& view, const SphericalPolygon<double>& polygon,
                             int points);

}  // namespace shlight
