// SPDX-License-Identifier: MIT
//
// The boundary integrals B_l = ∮ P_l(z) (x dy - y dx) of Zhou & Wei 2020 along circular arcs, for all lobes at once;
// z = ω·ω_d is the height along the lobe. Eq. 13 to 18, with F_l = ∫ z P_l'(z) dφ, whose z the paper's print has lost.
//
// Along the circle ω = cosα A + sinα (cosφ A_1 + sinφ A_2) the height is z = a + b cos(φ - φ_d) for any A_1 and A_2,
// with a = cosα A·ω_d and b² = sin²α (1 - (A·ω_d)²), and its slope is -b sin(φ - φ_d) = (A × ω)·ω_d. So no frame is
// made for a lobe and none degenerates where ω_d points along A: the ends of an arc enter as points.
#pragma once

#include "zonal_factorization.h"

namespace shlight::methods {

/// A point of the unit sphere, and there P_l(ω·ω_d) in rows l = 1 … order - 2; not initialised.
template <class T>
struct LobePoint {
    Vec3<T> point;
    LobeTable<T> legendre;

    void set(const Vec3<T>& unit, int order);
};

/// An arc run through counter-clockwise about the axis, the region on the left.
template <class T>
struct CircleArc {
    Vec3<T> axis;    ///< unit
    T cosine, sine;  ///< of the circle's half angle α
    T angle;         ///< about the axis, 0 … 2π
};

/// Rows 1 … order - 1 to zero.
template <class T>
void clear_boundary(LobeTable<T>& boundary, int order);

/// Each adds the integrals B_l, l = 0 … order - 2, to row l + 1. Precondition: order ≤ kMaxZonalOrder; nothing to do
/// for order 1.
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
