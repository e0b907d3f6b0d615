// SPDX-License-Identifier: MIT
//
// Spherical caps: the region that a sphere light covers, seen from a shading point, clipped by the horizon.
//
// Coefficients are the integrals of the basis over the kept region (Zhou & Wei 2020, Eq. 4 with unit radiance),
// by recurrences in the degree that cost O(order²) in all; docs/theory.md, 2 and 3, derives them.
#pragma once

#include <span>

#include "shlight/types.h"
#include "shlight/warp.h"

namespace shlight {

/// A cap {u : u·L ≥ cosσ} and what the horizon u_z ≥ z_0 keeps of it, as the recurrences want them.
///
/// Everything is worked out in double, whatever T: near contact and tangency the few scalars of a light amplify
/// rounding. The horizon is the plane z = 0, or the image of that plane where a warp is given; axes, centres and half
/// angles are always those before the warp.
template <class T>
struct Cap {
    T cos_tilt, sin_tilt;        ///< θ, the angle between the cap's axis L and z
    T cos_azimuth, sin_azimuth;  ///< the axis' azimuth about z
    T cos_half, sin_half;        ///< half angle σ, 0 < σ ≤ π
    T arc;                       ///< φ_a: the cap covers the horizon within φ_a of its axis' azimuth; 0 … π
    T cos_arc, sin_arc;
    T edge;         ///< ψ_0: the cap's edge is above the horizon within ψ_0 of its highest point; 0 … π
    T solid_angle;  ///< of the kept region
    bool crossing;  ///< whether the two circles cross; else arc and edge are 0 or π
    T horizon_height, horizon_sine;  ///< z_0 and √(1 - z_0²), which a narrow warp needs beside it

    /// The cap of a sphere; precondition 0 < radius ≤ |center|, all finite.
    static Cap of_sphere(const Vec3d& center, double radius, const Warp& warp = Warp());
    /// The cap of a disk that always faces the shading point: half angle atan(radius / |center|).
    static Cap of_facing_disk(const Vec3d& center, double radius, const Warp& warp = Warp());
    /// The cap about an axis of any length > 0; precondition 0 < half_angle ≤ π.
    static Cap about_axis(const Vec3d& axis, double half_angle, const Warp& warp = Warp());
    /// The cap on one side of a circle.
    static Cap inside(const Circle& circle, const Warp& warp = Warp());
    /// The cap about an axis that is seen against a horizon of this height, whatever put the horizon there.
    static Cap against(double horizon_height, double horizon_sine, const Vec3d& axis, double half_angle);

    /// The same cap without a horizon.
    Cap unclipped() const;
};

/// Cosine terms S_lm = ∫ Y_lm over the kept region, m ≥ 0, about the azimuth of the cap's axis: cosine_count(order)
/// values, with the √2 of the orthonormal basis.
template <class T>
void clipped_cap_terms(const Cap<T>& cap, int order, T* cosine_terms);

/// Σ f_lm L_lm for a lobe's cosine terms f_lm, cosine_count(order) of them: clipped_cap_terms turned to the cap's
/// azimuth and multiplied, band by band.
template <class T>
T shade_cap(const Cap<T>& cap, const T* lobe_terms, int order);

/// Coefficients of one cap that was made against the plane z = 0, order² values. clip: keep only what lies above it.
template <class T>
void cap_coefficients(const Cap<T>& cap, int order, bool clip, T* coefficients);

/// Sphere lights from centre and radius in the shading frame.
/// coefficients: centers.size() × order², row by row.
/// Throws std::invalid_argument naming the argument: order outside 1 … 64, sizes that do not fit, a non-finite number,
/// a radius ≤ 0, a shading point inside a sphere (|center| < radius; contact is allowed).
template <class T>
void sphere_coefficients(std::span<const Vec3<T>> centers, std::span<const T> radii, int order, bool clip,
                         std::span<T> coefficients, Output output = Output::cached);

/// Caps from axis (any length > 0) and half angle in (0, π] [rad]. Throws as sphere_coefficients does.
template <class T>
void cap_coefficients(std::span<const Vec3<T>> axes, std::span<const T> half_angles, int order, bool clip,
                      std::span<T> coefficients, Output output = Output::cached);

}  // namespace shlight
