// SPDX-License-Identifier: MIT
//
// The method of Zhou & Wei 2020: zonal integrals over a clipped cap by recurrences along its edge in Legendre functions
// (Eqs. 6 to 22).
#include <algorithm>

#include "arc_recurrence.h"
#include "cap_outline.h"
#include "method.h"

namespace shlight::methods {
namespace {

template <class T>
void add_outline(const CapAngles<T>& cap, const CapBoundary<T>& outline, int order, LobeTable<T>& boundary) {
    const CircleArc<T> edge{cap.axis, cap.cos_half, cap.sin_half, outline.edge};
    const CircleArc<T> horizon{Vec3<T>(0, 0, 1), T(0), T(1), outline.horizon};
    if (outline.crossing) {
        LobePoint<T> right, left;
        right.set(outline.right, order);
        left.set(outline.left, order);
        add_arc(edge, right, left, order, boundary);
        add_great_arc(horizon, left, right, order, boundary);
        return;
    }
    for (const CircleArc<T>& circle : {edge, horizon}) {
        if (circle.angle > 0) {
            add_circle(circle, order, boundary);
        }
    }
}

template <class T>
void cap(const CapLight& light, int order, bool clip, const Options& /*options*/, T* coefficients) {
    const CapAngles<T> angles(light);
    const CapBoundary<T> outline(angles, clip);
    if (!(outline.solid_angle > 0)) {
        std::fill_n(coefficients, coefficient_count(order), T(0));
        return;
    }
    LobeTable<T> integrals;
    clear_boundary(integrals, order);
    add_outline(angles, outline, order, integrals);
    zonal_coefficients(integrals, T(1), outline.solid_angle, order, coefficients);
}

}  // namespace

Method zhou_wei() {
    return {"zhou_wei",
            "Zhou & Wei 2020, Eq. 8 to 22: zonal factorization, Legendre recurrences along the edge",
            kMaxZonalOrder,
            false,
            false,
            {&cap<float>, nullptr},
            {&cap<double>, nullptr}};
}

}  // namespace shlight::methods
