// SPDX-License-Identifier: MIT
//
// Shadow rays of a scene, with the count of them and the time that they take.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>

#include "shlight/render_report.h"
#include "shlight/scene_rays.h"

namespace shlight {

/// One per thread.
class ShadowTracer {
  public:
    ShadowTracer(const SceneRays& rays, std::uint32_t transparent_bounces)
        : rays_(&rays), transparent_bounces_(transparent_bounces) {}

    /// Whether the share of light along a ray is 0 or 1 everywhere.
    bool is_opaque() const { return rays_->is_opaque(); }
    void visibility(std::span<const Ray> rays, std::span<Rgb> visible) {
        traced_ += rays.size();
        timed([&] { rays_->visibility(rays, transparent_bounces_, visible); });
    }
    /// To be called after intersect_opaque: as visibility, for surfaces that are not opaque.
    void transmittance(std::span<const Ray> rays, std::span<Rgb> visible, const SurfaceVisit& visit) {
        timed([&] { rays_->transmittance(rays, transparent_bounces_, visible, visit); });
    }
    void intersect_opaque(std::span<const Ray> rays, std::span<RayHit> hits) {
        traced_ += rays.size();
        timed([&] { rays_->intersect_opaque(rays, hits); });
    }

    /// Moves the rays and their time, which the stage `shadows` holds, to their places in the report.
    void move_to(RenderReport& report) {
        report.shadow_rays += traced_;
        report.stage_seconds[static_cast<std::size_t>(RenderStage::shadows)] -= seconds_;
        report.stage_seconds[static_cast<std::size_t>(RenderStage::shadow_rays)] += seconds_;
        traced_ = 0;
        seconds_ = 0;
    }

  private:
    template <class Trace>
    void timed(const Trace& trace) {
        const auto start = std::chrono::steady_clock::now();
        trace();
        seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }

    const SceneRays* rays_;
    std::uint32_t transparent_bounces_;
    std::uint64_t traced_ = 0;
    double seconds_ = 0;
};

}  // namespace shlight
