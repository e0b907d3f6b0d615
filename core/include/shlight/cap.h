// SPDX-License-Identifier: MIT
//
// Spherical caps: the region that a sphere light covers, seen from a shading point, clipped by the horizon z ≥ 0.
//
// Coefficients are the integrals of the basis over the kept region (Zhou & Wei 2020, Eq. 4 with unit radiance),
// by recurrences in the degree that cost O(order²) in all; docs/algorithms.md derives them.
#pragma once

#include <span>

#include "shlight/types.h"

namespace shlight {

/// A cap as the recurrences want it: sines and cosines that carry no cancellation for small or grazing caps.
template <class T>
struct Cap {
    T cos_tilt, sin_tilt;        ///< angle between the cap's axis and z
    T cos_azimuth, sin_azimuth;  ///< the axis' azimuth about z
    T cos_half, sin_half;        ///< half angle σ, 0 < σ ≤ π/2
    T crossing;       ///< √(sin²σ - cos²θ), the half chord of the horizon; 0 where cap and horizon do not cross
    bool complement;  ///< the region is everything *outside* this cap (half angles above π/2)

    /// The cap of a sphere; precondition 0 < radius ≤ |center|, all finite.
    static Cap of_sphere(const Vec3<T>& center, T radius);
    /// The cap of a disk that always faces the shading point: half angle atan(radius / |center|).
    static Cap of_facing_disk(const Vec3<T>& center, T radius);
    /// The cap about an axis of any length > 0; precondition 0 < half_angle ≤ π.
    static Cap about_axis(const Vec3<T>& axis, T half_angle);
};

/// Coefficients of one cap, order² values. clip: keep only what lies above the horizon.
template <class T>
void cap_coefficients(const Cap<T>& cap, int order, bool clip, T* coefficients);

/// Sphere lights from centre and radius in the shading frame.
/// coefficients: centers.size() × order², row by row.
/// Throws std::invalid_argument naming the argument: order outside 1 … 64, sizes that do not fit, a non-finite number,
/// a radius ≤ 0, a shading point inside a sphere (|center| < radius; contact is allowed).
template <class T>
void sphere_coefficients(std::span<const Vec3<T>> centers, std::span<const T> radii, int order, bool clip,
                         std::span<T> coefficients);

/// Caps from axis (any length > 0) and half angle in (0, π] [rad]. Throws as sphere_coefficients does.
template <class T>
void cap_coefficients(std::span<const Vec3<T>> axes, std::span<const T> half_angles, int order, bool clip,
                      std::span<T> coefficients);

}  // namespace shlight
