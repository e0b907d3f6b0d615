// SPDX-License-Identifier: MIT
//
// Shadow rays of a picture.
#pragma once

#include <cstdint>
#include <span>

#include "shlight/scene_rays.h"
#include "tracing/occluder_boxes.h"

namespace shlight {

class ShadowTracer {
  public:
    ShadowTracer(const SceneRays& rays, std::uint32_t transparent_bounces)
        : rays_(&rays), transparent_bounces_(transparent_bounces) {}

    /// Whether the share of light along a ray is 0 or 1 everywhere.
    bool is_opaque() const { return rays_->is_opaque(); }
    void visibility(std::span<const Ray> rays, std::span<Rgb> visible) const {
        rays_->visibility(rays, transparent_bounces_, visible);
    }
    void transmittance(std::span<const Ray> rays, std::span<Rgb> visible) const {
        rays_->transmittance(rays, transparent_bounces_, visible);
    }
    /// See OccluderBoxes.
    bool may_block(std::span<const Vec3f> points, const LightBounds& light) const {
        return rays_->boxes().may_block(points, light);
    }
    void intersect_opaque(std::span<const Ray> rays, std::span<RayHit> hits) const {
        rays_->intersect_opaque(rays, hits);
    }

  private:
    const SceneRays* rays_;
    std::uint32_t transparent_bounces_;
};

}  // namespace shlight
