// SPDX-License-Identifier: MIT
//
// Rays of one view as a lobe spreads them, and what the lobe makes of any rays: in lanes, one for each ray.
#pragma once

#include <cstddef>

#include "base/shading_frame.h"
#include "shlight/lobe_shape.h"
#include "shlight/types.h"

namespace shlight {

/// More values than asked for are read and written, less than one more than this.
inline constexpr std::size_t kLobeRayLanes = 16;

/// One vector for each ray.
struct RayVectors {
    float *x, *y, *z;
};

/// The directions of sample_lobe() at points (u, v), in the shading frame and up to a float's rounding.
/// view: above the horizon and in the xz-plane.
void sample_lobe_rays(const LobeShape& shape, const Vec3d& view, const float* u, const float* v, std::size_t count,
                      const RayVectors& directions);

/// lobe_value() and lobe_density() of rays along the axes of the world, of any length. A mirror's are those of a very
/// narrow lobe. densities: null where nobody asks for them.
void weigh_lobe_rays(const LobeShape& shape, const ShadingFrame& frame, const Vec3d& view, const RayVectors& ways,
                     std::size_t count, float* values, float* densities);

}  // namespace shlight
