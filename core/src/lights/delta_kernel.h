// SPDX-License-Identifier: MIT
//
// Directions and irradiance of many sources without extent at one point.
#pragma once

#include <cstddef>

#include "shlight/types.h"
#include "tracing/hits.h"

namespace shlight {

/// Sources, one lane for each: position (x, y, z) and w = 1, or the unit direction to an infinitely distant source and
/// w = 0. Padding at the end has x = y = z = w = 0.
struct DeltaArrays {
    const double *x, *y, *z, *w;
    std::size_t count;  ///< a multiple of kDeltaLanes
};

/// A multiple of every machine's number of lanes.
inline constexpr std::size_t kDeltaLanes = 16;

/// Unit directions to the sources in the shading frame, and the irradiance on a perpendicular surface from a source of
/// strength 1. All are 0 for a source below the horizon or nearer than least_distance.
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
