// SPDX-License-Identifier: MIT
//
// The reference for caps in angles of 113 bits. Included by the quad_*.cpp files only.
#pragma once

#include "quad_math.h"

namespace shlight::truth {

/// A cap by tilt and half angle, and the azimuth of its axis.
struct CapAngles {
    quad tilt, half;
    quad cos_azimuth, sin_azimuth;
};

quad half_angle(const CapInput& input);
CapAngles cap_angles(const Vec3q& axis, quad half);

/// order² coefficients of the intersection of a cap and the cap of half angle `horizon` about z.
Coefficients cap_above(const CapAngles& cap, quad horizon, int order, int extra_nodes);
Coefficients cap_by_slices(const CapAngles& cap, quad horizon, int order);

}  // namespace shlight::truth
