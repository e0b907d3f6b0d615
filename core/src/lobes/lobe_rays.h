// SPDX-License-Identifier: MIT
//
// Rays drawn from a lobe at one view, and the lobe's value and density for any rays, one lane for each ray.
#pragma once

#include <cstddef>

#include "base/shading_frame.h"
#include "shlight/lobe_shape.h"
#include "shlight/types.h"

namespace shlight {

/// Arrays of rays are read and written up to the next multiple of this.
inline constexpr std::size_t kLobeRayLanes = 16;

/// Vectors of rays, one array for each component.
struct RayVectors {
    float *x, *y, *z;
};
struct ConstRayVectors {
    const float *x, *y, *z;
};

/// The directions of sample_lobe() at points (u, v), in the shading frame and up to a float's rounding.
/// view: above the horizon and in the xz-plane.
void sample_lobe_rays(const LobeShape& shape, const Vec3d& view, const float* u, const float* v, std::size_t count,
                      const RayVectors& directions);

/// lobe_value() and lobe_density() of rays, whose vectors are in world axes and of any length. A mirror counts as a
/// very narrow lobe. densities: may be null.
void weigh_lobe_rays(const LobeShape& shape, const ShadingFrame& frame, const Vec3d& view, const ConstRayVectors& ways,
                     std::size_t count, float* values, float* densities);

}  // namespace shlight
