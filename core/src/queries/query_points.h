// SPDX-License-Identifier: MIT
//
// Rays and points that are asked about, in a compiled scene's frame.
#pragma once

#include <span>
#include <vector>

#include "base/shading_frame.h"
#include "shlight/ray_tracer.h"
#include "shlight/scene.h"
#include "shlight/types.h"
#include "tracing/hits.h"

namespace shlight {

/// A ray with a unit direction.
Ray query_ray(const CompiledScene& scene, const Vec3d& origin, const Vec3d& direction);

/// Points as hits, one of each group, with one white lobe of weight 1 seen along the normal. One thread fills them at a
/// time.
class QueryPoints {
  public:
    explicit QueryPoints(const CompiledScene& scene) : scene_(&scene), hits_(1) {}

    /// Forgets all others. points: in the world; frames: their axes. A point on a surface has the error that a ray's
    /// hit there has, so that the surface does not shadow it.
    void set(std::span<const Vec3d> points, std::span<const ShadingFrame> frames);
    Hits& hits() { return hits_; }

  private:
    double error(const Vec3d& point, std::size_t first) const;

    const CompiledScene* scene_;
    Hits hits_;
    std::vector<Ray> rays_;  // to both sides of each point
    std::vector<RayHit> met_;
};

}  // namespace shlight
