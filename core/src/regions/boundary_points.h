// SPDX-License-Identifier: MIT
//
// How many points an integral along the boundary of a cone takes.
//
// The boundary ω(u) is analytic in the strip |Im u| < K', where it has poles. At the height s a harmonic of degree l
// has grown by at most e^{l η(s)}, sinh η = |Im ω| ≤ sin_long sc(s | k'²). Trapezoids around the whole boundary then
// err by e^{-2π s N / 4K}, N Gauss points on a piece of half length h by e^{-2 N asinh(s/h)}, times that; the best of a
// few s is taken.
#pragma once

#include <array>

#include "regions/arcs.h"
#include "regions/spherical_ellipse.h"

namespace shlight {

class BoundaryPoints {
  public:
    /// sin_long: sine of the cone's longer half angle; complement: its k'.
    BoundaryPoints(double sin_long, double complement);

    /// So many points that harmonics of this degree err by e^-digits of their height.
    /// quarter: K. All pieces of the closed boundary have the same number of points, together they are equidistant.
    Division closed(double quarter, double degree, double digits) const;
    /// half: half of the length in u.
    Division open(double half, double degree, double digits) const;
    /// The same where the integrand has other poles at this height.
    Division open(double half, double degree, double digits, double pole) const;

  private:
    struct Height {
        double s, growth;
    };
    std::array<Height, 6> heights_;
};

/// Gauss points across a line on the sphere that reaches from -half to half [rad], half < π/2.
int points_across(double half, double degree, double digits);

/// Natural logarithm of the reciprocal of what a harmonic's integral over a disk may err by, as a part of its largest
/// value along the boundary, for coefficients whose roundings are `epsilon`.
double digits_for(const SphericalEllipse& ellipse, int order, double epsilon);

}  // namespace shlight
