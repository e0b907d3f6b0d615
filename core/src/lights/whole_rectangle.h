// SPDX-License-Identifier: MIT
//
// Shadow rays to the most frequent light: a rectangle that shines evenly, all of it above a hit's horizon and about
// equally far. Its points are drawn evenly over the area, which costs no angles, in the world, which costs no frames,
// and in lanes, one for each ray.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "base/shading_frame.h"
#include "math/light_sample.h"
#include "shlight/light.h"
#include "shlight/sampling.h"
#include "shlight/types.h"

namespace shlight {

/// Such a light as a hit sees it. What is a way goes from the hit, along the axes of the world.
struct WholeRectangle {
    /// Nothing for any other light, or where it is not seen whole. error: see SurfacePoint.
    static std::optional<WholeRectangle> see(const Light& light, const ShadingFrame& frame, double error);

    /// One point, in the shading frame; as place_points() has it.
    LightSample sample(const ShadingFrame& frame, const glm::dvec2& point) const;

    Vec3f corner;          ///< the way to it
    Vec3f along, across;   ///< its edges
    float nearest_square;  ///< at least so far is every point, squared
    float most_weight;     ///< of a point as near as that
};

/// Points of a light: the way to each, and its weight. The mean of weight · g is the integral of g over the light's
/// solid angle.
struct LightPointArrays {
    float *x, *y, *z, *weight;
};

/// More values than asked for are read and written, less than one more than this.
inline constexpr std::size_t kLightPointLanes = 16;

/// Points number first … first + count - 1 of a sequence, as its point() has them up to 2⁻²³.
void draw_square_points(const SobolSequence& sequence, std::uint32_t first, std::size_t count, float* u, float* v);

/// Where points of the unit square lie on a rectangle.
void place_points(const WholeRectangle& rectangle, const float* u, const float* v, std::size_t count,
                  const LightPointArrays& points);

/// Where directions from the hit, given in its shading frame, meet a rectangle: the points may have replaced them. The
/// weight is 0 where they miss it.
void meet_rectangle(const WholeRectangle& rectangle, const ShadingFrame& frame, std::size_t count,
                    const LightPointArrays& points);

}  // namespace shlight
