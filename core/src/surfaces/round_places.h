// SPDX-License-Identifier: MIT
//
// Places on curves and spheres that rays have met.
#pragma once

#include <span>

#include "shlight/mesh.h"
#include "shlight/ray_tracer.h"
#include "shlight/types.h"

namespace shlight {

/// Error of a hit on a curve or a sphere ÷ its radius: rays meet ribbons in flat pieces.
inline constexpr double kRoundRounding = 1e-3;

/// A vector of length 1, or the fallback if it has no length.
Vec3d normalized_or(const Vec3d& v, const Vec3d& fallback);

/// On the middle of a curve, or in that of a sphere.
struct RoundPlace {
    SurfaceForm form;
    Vec3d position;
    Vec3d along;  ///< ∂P/∂u of a curve, else 0
    double radius;
};

/// vertices, radius_scale: see CompiledMesh. Of curves the spline of Catmull & Rom 1974, "A class of local
/// interpolating splines", whose ends have their points twice.
RoundPlace round_place(const MeshShape& shape, std::span<const Vec3f> vertices, double radius_scale, const RayHit& hit);

/// The unit normal, in the shape's frame: of a sphere or a tube its own, at right angles to the curve; of a ribbon that
/// of a tube as wide as it, as in Cycles.
struct OutwardNormal {
    Vec3d normal;
    Vec3d lift{0};  ///< from a ribbon to the tube ÷ their radius
};

/// direction: of the ray.
OutwardNormal outward_normal(const RoundPlace& place, const RayHit& hit, const Vec3d& direction);

}  // namespace shlight
