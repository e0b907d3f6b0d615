// SPDX-License-Identifier: MIT
//
// Spherical caps clipped by the horizon: the region that a sphere light covers, seen from a shading point.
//
// Coefficients are the integrals of the basis over the kept region (Zhou & Wei 2020, Eq. 4 with unit radiance), by
// recurrences in the degree m that take O(order²) operations; docs/theory.md, 2 and 3, derives them.
#pragma once

#include <span>

#include "shlight/types.h"

namespace shlight {

/// The directions ω with ω·axis ≥ cosine.
struct SphericalCap {
    Vec3d axis;     ///< unit
    double cosine;  ///< of the half angle, which may be anything in 0 … π
    double sine;    ///< ≥ 0; given beside the cosine because small caps need it
};

/// The cap that a sphere covers, seen from the origin; precondition 0 < radius ≤ |center|, all finite.
/// |c|² - r² by exact products: near contact it is a small difference of the inputs.
SphericalCap cap_of_sphere(const Vec3d& center, double radius);
/// The cap that a disk covers which always faces the origin: half angle atan(radius / |center|); center ≠ 0.
SphericalCap cap_of_facing_disk(const Vec3d& center, double radius);
/// The cap of a half angle [rad] about an axis of any length > 0; 0 < half_angle, more than π counts as π.
SphericalCap cap_about_axis(const Vec3d& axis, double half_angle);

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

/// Caps that are not checked.
template <class T>
void cap_coefficients(std::span<const SphericalCap> caps, int order, bool clip, std::span<T> coefficients);

/// Solid angle of the part of a cap above z = 0 (Eq. 21 of Zhou & Wei 2020).
double clipped_solid_angle(const SphericalCap& cap);

}  // namespace shlight
