// SPDX-License-Identifier: MIT
//
// Rays through a scene whose surfaces may let light through: opaque triangles and others are traced apart, so that the
// opaque ones do not pay for the others.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "shlight/ray_tracer.h"
#include "shlight/types.h"

namespace shlight {

/// How much of the light a surface lets through.
class SurfaceTransparency {
  public:
    SurfaceTransparency() = default;
    SurfaceTransparency(const SurfaceTransparency&) = delete;
    SurfaceTransparency& operator=(const SurfaceTransparency&) = delete;
    virtual ~SurfaceTransparency() = default;
    /// Evaluates surfaces that shadow rays have met. depth: number of such surfaces that each ray has passed before;
    /// passed: not negative. entered: the absorption [1/m] of the body that a ray enters there, minus it where the ray
    /// leaves the body.
    virtual void find(std::span<const Ray> rays, std::span<const RayHit> hits, std::uint32_t depth,
                      std::span<Rgb> passed, std::span<Rgb> entered) const = 0;
};

/// A surface that the ray of this number meets.
using SurfaceVisit = std::function<void(std::size_t ray, const RayHit& hit)>;

/// The rest of a ray behind a surface that it has met.
Ray behind(const Ray& ray, const RayHit& hit);

/// Immutable; any number of threads may trace at a time.
class SceneRays {
  public:
    /// opaque, transparent: triangles of the same instances.
    /// Builds as RayTracer does, and throws what it throws. transparency must outlive this.
    SceneRays(std::vector<TracedInstance> opaque, std::vector<TracedInstance> transparent,
              const SurfaceTransparency& transparency, const Stopped& stopped = {});
    /// Shares the trees of the same surfaces. transparency must outlive this.
    SceneRays(const SceneRays& same, const SurfaceTransparency& transparency);
    SceneRays(const SceneRays&) = delete;
    SceneRays& operator=(const SceneRays&) = delete;
    ~SceneRays();

    /// Whether all surfaces are.
    bool is_opaque() const { return transparent_ == nullptr; }
    /// The first surface that each ray meets, opaque or not.
    void intersect(std::span<const Ray> rays, std::span<RayHit> hits) const;
    void intersect_opaque(std::span<const Ray> rays, std::span<RayHit> hits) const;
    /// Adds what RayTracer::near() finds of all surfaces.
    void near(const Vec3f& point, float radius, std::vector<RayHit>& found) const;
    void near_opaque(const Vec3f& point, float radius, std::vector<RayHit>& found) const;
    /// The share of light that reaches the end of each ray. transparent_bounces: surfaces that a ray passes through, at
    /// most.
    void visibility(std::span<const Ray> rays, std::uint32_t transparent_bounces, std::span<Rgb> visible) const;
    /// Multiplies `visible` with the same of the surfaces alone that are not opaque. visit(ray, hit), unless it is
    /// null: for each such surface, from front to back, when `visible` is the share of light that gets from there to
    /// the ray's origin, if no body absorbs it.
    void transmittance(std::span<const Ray> rays, std::uint32_t transparent_bounces, std::span<Rgb> visible,
                       const SurfaceVisit& visit = {}) const;

  private:
    std::shared_ptr<const RayTracer> opaque_, transparent_;  // null: there are no such surfaces
    const SurfaceTransparency* transparency_;
};

}  // namespace shlight
