// SPDX-License-Identifier: MIT
//
// Derivatives of the coefficients of caps by what moves them, many at once.
#pragma once

#include <cstddef>

#include "shlight/types.h"

namespace shlight {

/// A sphere's cap, and how it moves with the sphere.
template <class T>
struct CapMotion {
    T x, y, z;         ///< the cap's axis L
    T over_distance;   ///< 1/|c|
    T over_depth;      ///< 1/(|c| cosσ)
    T over_rim;        ///< 1/(|c| sinσ cosσ)
    T azimuth_cosine;  ///< of L
    T azimuth_sine;    //
    T cut_cosine;      ///< of φ_a, half the angle of the horizon within the cap
    T cut_sine;        //
    T cut;             ///< φ_a; 0: the horizon does not cut the cap
    T unused;
};

/// caps: count of them, with (order + 1)² coefficients each in `rows`, which must be readable 4 numbers beyond their
/// end. by_center: order² × 3 numbers of each; by_radius: order².
void write_cap_motion(const CapMotion<float>* caps, std::size_t count, int order, const float* rows, float* by_center,
                      float* by_radius);
void write_cap_motion(const CapMotion<double>* caps, std::size_t count, int order, const double* rows,
                      double* by_center, double* by_radius);

}  // namespace shlight
