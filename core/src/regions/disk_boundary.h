// SPDX-License-Identifier: MIT
//
// Coefficients of disks by Stokes' theorem along their boundaries (docs/theory.md, 5.1 to 5.3).
#pragma once

#include "regions/ellipse_rows.h"
#include "regions/polygon_rows.h"
#include "regions/spherical_ellipse.h"

namespace shlight {

/// Boundaries of many disks, for add_cone_coefficients and add_arc_coefficients.
template <class R>
struct DiskBoundarys {
    ConeLists<R> cones;
    ArcLists<R> horizon;

    void clear() {
        cones.clear();
        horizon.clear();
    }
};

/// Whether the points go through the recurrences in float, twice as many at once: wide boundaries lose nothing by it
/// that float could hold, as with polygons; the result is right to 4e-6 of L_00. Up to order 2 double costs next to
/// nothing.
template <class T>
bool disk_boundary_in_float(const SphericalEllipse<Wider<T>>& ellipse, int order);

/// A disk's boundary under its number into lists, to the precision of T. coefficients: order² zeros, to which bands 0
/// and 1 of what lies along the horizon are added.
template <class T, class R>
void start_disk_boundary(const SphericalEllipse<Wider<T>>& ellipse, int order, std::size_t number,
                         DiskBoundarys<R>& boundaries, R* coefficients);

/// Adds what the lists hold to order² numbers for each disk, row by row.
template <class R>
void add_disk_boundarys(const DiskBoundarys<R>& boundaries, int order, R* coefficients) {
    add_cone_coefficients(boundaries.cones, order, coefficients);
    add_arc_coefficients(boundaries.horizon, order, coefficients);
}

/// Natural logarithm of what a harmonic's integral may err by, as a part of its largest value along the boundary.
template <class T>
double digits_for(const SphericalEllipse<Wider<T>>& ellipse, int order);

}  // namespace shlight
