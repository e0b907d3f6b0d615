// SPDX-License-Identifier: MIT
//
// References for planar ellipses, in 113 bits: points of the ellipse itself, no cone and no elliptic functions.
#pragma once

#include "quad_truth.h"

namespace shlight::truth {

/// center + a u + b v with a² + b² ≤ 1.
struct EllipseInput {
    Vec3d center, half_axis_u, half_axis_v;
};

/// order² coefficients of an ellipse seen from the origin, taken with positive area: the slices of quad_truth.h, summed
/// along its outline on panels that shrink as it comes near the origin.
Coefficients ellipse(const EllipseInput& input, int order, bool clip, int extra_nodes = 0);

}  // namespace shlight::truth
