// SPDX-License-Identifier: MIT
//
// Coefficients of disks by Stokes' theorem along their outlines (docs/algorithms.md, "Disks and ellipses").
#pragma once

#include "kernels/ellipse_rows.h"
#include "spherical_ellipse.h"

namespace shlight {

/// Outlines of many disks, for add_cone_coefficients and add_arc_coefficients.
struct DiskOutlines {
    ConeLists<double> cones;
    ArcLists<double> horizon;

    void clear() {
        cones.clear();
        horizon.clear();
    }
};

/// A disk's outline under its number into lists, to the precision of T. coefficients: order² zeros, to which bands 0
/// and 1 of what lies along the horizon are added.
template <class T>
void start_disk_outline(const SphericalEllipse<Wider<T>>& ellipse, int order, std::size_t number,
                        DiskOutlines& outlines, double* coefficients);

/// Adds what the lists hold to order² numbers for each disk, row by row.
void add_disk_outlines(const DiskOutlines& outlines, int order, double* coefficients);

/// Natural logarithm of what a harmonic's integral may err by, as a part of its largest value along the outline.
template <class T>
double digits_for(const SphericalEllipse<Wider<T>>& ellipse, int order);

}  // namespace shlight
