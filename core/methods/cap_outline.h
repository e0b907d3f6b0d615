// SPDX-License-Identifier: MIT
//
// What the horizon keeps of a cap, as the zonal methods want it: the edge as arcs (Zhou & Wei 2020, Fig. 2 and Eq. 19
// to 21), in T from the directions and angles on.
#pragma once

#include "method.h"

namespace shlight::methods {

/// The kept region's edge: an arc of the cap's own circle, an arc of the horizon, or both.
template <class T>
struct CapOutline {
    T solid_angle = 0;
    T edge = 0;             ///< length of the circle's arc about the cap's axis, 0 … 2π
    T horizon = 0;          ///< length of the horizon's arc about z, 0 … 2π
    bool crossing = false;  ///< whether the circles cross; else both lengths are 0 or 2π
    Vec3<T> right, left;    ///< where they cross: the edge runs from right to left, the horizon from left to right

    CapOutline(const CapAngles<T>& cap, bool clip);

  private:
    void set_crossing(const CapAngles<T>& cap, T sin_tilt, T chord);
};

extern template struct CapOutline<float>;
extern template struct CapOutline<double>;

}  // namespace shlight::methods
