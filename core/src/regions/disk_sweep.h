// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "regions/spherical_ellipse.h"

namespace shlight {

/// order² coefficients by Gauss cubature on lines across what is kept of a disk, all weights positive: to the precision
/// epsilon however thin it is (docs/theory.md, 5.4). Precondition: can_be_swept.
std::vector<double> disk_by_sweep(const SphericalEllipse& ellipse, int order, double epsilon);

/// Whether its shorter half angle is at most about 1 or it is a low sliver above the horizon, as all thin ones are.
bool can_be_swept(const SphericalEllipse& ellipse);

}  // namespace shlight
