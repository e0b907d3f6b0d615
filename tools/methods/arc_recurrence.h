// SPDX-License-Identifier: MIT
//
// The boundary integrals B_l = ∮ P_l(z) (x dy - y dx) of Zhou & Wei 2020 along circular arcs, for all lobes at once; z
// = ω·ω_d is the height along the lobe. Eqs. 13 to 18 with F_l = ∫ z P_l'(z) dφ; Eq. 17 as printed lacks this z.
//
// Along the circle ω = cosα A + sinα (cosφ A_1 + sinφ A_2) the height is z = a + b cos(φ - φ_d) for any A_1 and A_2,
// with a = cosα A·ω_d and b² = sin²α (1 - (A·ω_d)²), and its slope is -b sin(φ - φ_d) = (A × ω)·ω_d. No frame is needed
// for a lobe, and nothing degenerates where ω_d is along A: the ends of an arc enter as points.
#pragma once

#include "zonal_factorization.h"

namespace shlight::methods {

/// A point of the unit sphere, with P_l(ω·ω_d) in rows l = 1 … order - 2; not initialised.
template <class T>
struct LobePoint {
    Vec3<T> point;
    LobeTable<T> legendre;

    void set(const Vec3<T>& unit, int order);
};

/// An arc, counter-clockwise about the axis, with the region on its left.
template <class T>
struct CircleArc {
    Vec3<T> axis;    ///< unit
    T cosine, sine;  ///< cosα and sinα, α being the circle's half angle
    T angle;         ///< length about the axis, 0 … 2π
};

/// Rows 1 … order - 1 to zero.
template <class T>
void clear_boundary(LobeTable<T>& boundary, int order);

/// The functions below add B_l, l = 0 … order - 2, to row l + 1. Precondition: order ≤ kMaxZonalOrder; order 1 has no
/// rows.
template <class T>
void add_arc(const CircleArc<T>& arc, const LobePoint<T>& from, const LobePoint<T>& to, int order,
             LobeTable<T>& boundary);
/// A whole circle: its ends cancel, angle is 2π.
template <class T>
void add_circle(const CircleArc<T>& circle, int order, LobeTable<T>& boundary);
/// An arc of a great circle: cosine is 0, sine 1 (Wang & Ramamoorthi 2018 for polygons).
template <class T>
void add_great_arc(const CircleArc<T>& arc, const LobePoint<T>& from, const LobePoint<T>& to, int order,
                   LobeTable<T>& boundary);

}  // namespace shlight::methods
