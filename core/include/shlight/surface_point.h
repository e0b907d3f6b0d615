// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "shlight/types.h"

namespace shlight {

/// A surface where a ray has met it, turned to the side that the ray came from.
struct SurfacePoint {
    Vec3d position;
    Vec3d geometric_normal;  ///< unit
    Vec3d shading_normal;    ///< unit, on the side of the geometric normal
    /// Bound of the distance between this point and the surface that float rays meet here.
    double error;
    std::uint32_t material;
};

}  // namespace shlight
