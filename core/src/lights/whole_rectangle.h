// SPDX-License-Identifier: MIT
//
// Shadow rays to the most frequent kind of light: an even rectangle that is entirely above a hit's horizon and about
// equally far everywhere. Its points are drawn uniformly by area, which needs no angles, in world axes, which needs no
// frames, and in lanes, one for each ray.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "base/shading_frame.h"
#include "shlight/light.h"
#include "shlight/sampling.h"
#include "shlight/types.h"

namespace shlight {

/// Such a light seen from a hit. Vectors start at the hit and are along the axes of the world.
struct WholeRectangle {
    /// Nothing for other lights, and for rectangles that are partly below the horizon. error: see SurfacePoint.
    static std::optional<WholeRectangle> see(const Light& light, const ShadingFrame& frame, double error);

    Vec3f corner;          ///< vector from the hit to the first vertex
    Vec3f along, across;   ///< the edges from there
    float nearest_square;  ///< lower bound of the squared distance to all points
    float most_weight;     ///< weight of a point at that distance
};

/// Points of a light: the vector to each, and its weight. The mean of weight · g is the integral of g over the light's
/// solid angle.
struct LightPointArrays {
    float *x, *y, *z, *weight;
};

/// Arrays of points are read and written up to the next multiple of this.
inline constexpr std::size_t kLightPointLanes = 16;

/// Points first … first + count - 1 of a sequence; they agree with SobolSequence::point() up to 2⁻²³.
void draw_square_points(const SobolSequence& sequence, std::uint32_t first, std::size_t count, float* u, float* v);

/// The points of a rectangle for points of the unit square.
void place_points(const WholeRectangle& rectangle, const float* u, const float* v, std::size_t count,
                  const LightPointArrays& points);

/// Replaces directions in `points`, in the shading frame of the hit, by the points where they meet the rectangle. The
/// weight is 0 for directions that miss it.
void meet_rectangle(const WholeRectangle& rectangle, const ShadingFrame& frame, std::size_t count,
                    const LightPointArrays& points);

}  // namespace shlight
