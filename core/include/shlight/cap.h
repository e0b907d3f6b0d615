// SPDX-License-Identifier: MIT
//
// Spherical caps clipped by the horizon: the region that a sphere light covers, seen from a shading point.
//
// Coefficients are the integrals of the basis over the kept region (Zhou & Wei 2020, Eq. 4 with unit radiance), by
// recurrences in the degree m that take O(order²) operations; docs/theory.md, 2 and 3, derives them.
#pragma once

#include <span>

#include "shlight/types.h"
#include "shlight/warp.h"

namespace shlight {

/// Sphere lights from centre and radius in the shading frame.
/// coefficients: centers.size() × order², row by row. clip: keep only the part above the plane z = 0.
/// Throws std::invalid_argument naming the argument: order outside 1 … 64, sizes that do not fit, a non-finite number,
/// a radius ≤ 0, a shading point inside a sphere (|center| < radius; contact is allowed).
template <class T>
void sphere_coefficients(std::span<const Vec3<T>> centers, std::span<const T> radii, int order, bool clip,
                         std::span<T> coefficients, Output output = Output::cached);

/// Caps from axis (any length > 0) and half angle in (0, π] [rad]. Throws as sphere_coefficients does.
template <class T>
void cap_coefficients(std::span<const Vec3<T>> axes, std::span<const T> half_angles, int order, bool clip,
                      std::span<T> coefficients, Output output = Output::cached);

/// The caps inside circles, which are not checked.
template <class T>
void circle_coefficients(std::span<const Circle> circles, int order, bool clip, std::span<T> coefficients);

/// Solid angle of the part above z = 0 of the cap inside a circle (Eq. 21 of Zhou & Wei 2020).
double clipped_solid_angle(const Circle& circle);

}  // namespace shlight
