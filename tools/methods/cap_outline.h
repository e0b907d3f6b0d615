// SPDX-License-Identifier: MIT
//
// The part of a cap above the horizon for zonal methods: its edge as arcs (Zhou & Wei 2020, Fig. 2 and Eqs. 19 to 21),
// computed in T from directions and angles.
#pragma once

#include "method.h"

namespace shlight::methods {

/// The kept region's edge: an arc of the cap's own circle, an arc of the horizon, or both.
template <class T>
struct CapBoundary {
    T solid_angle = 0;
    T edge = 0;             ///< length of the circle's arc about the cap's axis, 0 … 2π
    T horizon = 0;          ///< length of the horizon's arc about z, 0 … 2π
    bool crossing = false;  ///< whether the circles cross; else both lengths are 0 or 2π
    Vec3<T> right, left;    ///< crossings: the edge runs from right to left, the horizon from left to right

    CapBoundary(const CapAngles<T>& cap, bool clip);

  private:
    void set_crossing(const CapAngles<T>& cap, T sin_tilt, T chord);
};

extern template struct CapBoundary<float>;
extern template struct CapBoundary<double>;

}  // namespace shlight::methods
