// SPDX-License-Identifier: MIT
#pragma once

#include "regions/spherical_ellipse.h"

namespace shlight {

/// order² coefficients by Gauss cubature on lines across what is kept of a disk, all weights positive: to the precision
/// of T however thin it is (docs/theory.md, 5.4). Precondition: can_be_swept.
template <class T>
void disk_by_sweep(const SphericalEllipse<Wider<T>>& ellipse, int order, T* coefficients);

/// Whether its shorter half angle is at most about 1 or it is a low sliver above the horizon, as all thin ones are.
template <class Real>
bool can_be_swept(const SphericalEllipse<Real>& ellipse);

}  // namespace shlight
