// SPDX-License-Identifier: MIT
//
// Shadow rays from a hit, in float, so that neither the hit's own surface nor the light's blocks them.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "base/ray_rounding.h"
#include "shlight/light.h"
#include "shlight/ray_tracer.h"
#include "shlight/types.h"
#include "tracing/hits.h"

namespace shlight {

/// Offset of a shadow ray's end from the sampled point of the light: a polygon may lie in a mesh's face, its own or
/// that on which it is mounted, which must not block the ray. The error of a ray in float grows with its length.
Vec3d target_offset(const Light& light, const ShadingFrame& frame);

/// Shadow rays of one hit, in float but for the way from the rounded origin.
class ShadowRaySpawner {
  public:
    /// origin: off the surface; target_offset: of the rays' ends, see target_offset(); kinds: of the rays.
    ShadowRaySpawner(const ShadingFrame& frame, const Vec3d& origin, const Vec3d& target_offset,
                     std::uint32_t kinds = kShadowRay)
        : origin_(origin),
          x_(frame.x),
          y_(frame.y),
          z_(frame.z),
          offset_(frame.origin - Vec3d(origin_) + target_offset),
          local_offset_(frame.to_local(frame.origin - Vec3d(origin_) + target_offset)),
          kinds_(kinds) {}

    /// To a point in the shading frame, given by a unit direction and a distance.
    /// Infinitely far: without an end.
    Ray towards(const Vec3d& local_direction, double distance) const {
        if (std::isinf(distance)) {
            return along(local_direction);
        }
        const Vec3f way(distance * local_direction + local_offset_);
        return {origin_, 0.0F, way.x * x_ + way.y * y_ + way.z * z_, kRayEnd, kinds_};
    }

    /// To the end of a way from the hit, along the axes of the world. Each number is written once: GCC makes a copy of
    /// a Ray wait for the stores before it.
    void to_end_of(const Vec3f& way, Ray& ray) const {
        ray.origin.x = origin_.x;
        ray.origin.y = origin_.y;
        ray.origin.z = origin_.z;
        ray.t_min = 0;
        ray.direction.x = way.x + offset_.x;
        ray.direction.y = way.y + offset_.y;
        ray.direction.z = way.z + offset_.z;
        ray.t_max = kRayEnd;
        ray.kinds = kinds_;
    }

    /// Without an end.
    Ray along(const Vec3d& local_direction) const {
        const Vec3f way(local_direction);
        return {origin_, 0.0F, way.x * x_ + way.y * y_ + way.z * z_, std::numeric_limits<float>::infinity(), kinds_};
    }

  private:
    Vec3f origin_, x_, y_, z_, offset_;
    Vec3d local_offset_;
    std::uint32_t kinds_;
};

}  // namespace shlight
