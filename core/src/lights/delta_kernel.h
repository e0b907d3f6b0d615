// SPDX-License-Identifier: MIT
//
// Many sources without extent, seen from one point.
#pragma once

#include <cstddef>

#include "shlight/types.h"
#include "tracing/hits.h"

namespace shlight {

/// One lane each: the position (x, y, z) for w = 1, the unit direction to a source infinitely far away for w = 0. All
/// four 0: none, so that a vector can be filled up.
struct DeltaArrays {
    const double *x, *y, *z, *w;
    std::size_t count;  ///< a multiple of kDeltaLanes
};

/// The lanes of any machine divide it.
inline constexpr std::size_t kDeltaLanes = 16;

/// Unit directions to the sources in the shading frame, and the irradiance on a surface at right angles, of a source of
/// strength 1. All 0 for one that is below the horizon or nearer than least_distance.
struct DeltaViewArrays {
    double *x, *y, *z, *irradiance;
};

void see_deltas(const DeltaArrays& deltas, const ShadingFrame& frame, double least_distance,
                const DeltaViewArrays& views);

/// The square of the distance to the nearest source; infinite where there is none at a finite distance.
double nearest_delta_square(const DeltaArrays& deltas, const Vec3d& position);

/// Σ values[i] weights[i].
struct ColorArrays {
    const float *r, *g, *b;
};
Rgb weighted_sum(const float* values, const ColorArrays& weights, std::size_t count);

/// sums[i] += values[i] weight · colors[i].
void add_weighted(const float* values, const ColorArrays& colors, const Rgb& weight, std::size_t count, float* sums);

}  // namespace shlight
