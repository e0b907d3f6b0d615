// SPDX-License-Identifier: MIT
//
// A light as the target of shadow rays: what draws points of it, meets it in given directions, and tells what it sends
// from there. Lights with extent and the environment are drawn, traced and weighed alike (see ShadowRays).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/scratch.h"
#include "lighting/sky_guide.h"
#include "lights/face_sampling.h"
#include "lights/light_sampling.h"
#include "lights/local_light.h"
#include "lights/shadow_ray_spawner.h"
#include "lights/whole_rectangle.h"
#include "lobes/lobe_rays.h"
#include "shlight/environment.h"
#include "shlight/light.h"
#include "tracing/hits.h"
#include "tracing/shadow_tracer.h"

namespace shlight {

/// Rays that are drawn together; a multiple of all lanes.
inline constexpr std::uint32_t kRaysAtOnce = 64;

/// A shadow ray before it is traced.
struct DrawnRay {
    Vec3f way;            ///< from the hit, along the axes of the world; of any length
    float light_density;  ///< per solid angle, of the points that the light draws; 0: of an environment, see
                          ///< find_radiance
    float radiance;       ///< the light's there ÷ ShadowTarget::strength()
    bool hidden_layer;    ///< behind another layer of the light
};

/// The shadow rays of many hits.
struct DrawnRays {
    Scratch<DrawnRay> drawn;
    Scratch<Ray> rays;            ///< as drawn
    std::vector<Rgb> visible;     ///< once traced
    std::vector<Rgb> color;       ///< factors of DrawnRay::radiance; empty: 1
    std::vector<Rgb> spot_color;  ///< likewise, of bright spots
    std::vector<float> guided;    ///< if there is a guide: its factor of the light's density, or 0 where it has none

    void clear();
    std::size_t size() const { return drawn.size(); }
    void push(const DrawnRay& ray, const Ray& way) {
        drawn.extend(1)[0] = ray;
        rays.extend(1)[0] = way;
    }
};

/// Keeps its memory from hit to hit; one per thread.
class ShadowTarget {
  public:
    ShadowTarget() = default;
    ShadowTarget(const ShadowTarget&) = delete;
    ShadowTarget& operator=(const ShadowTarget&) = delete;
    virtual ~ShadowTarget() = default;

    /// Forgets all hits.
    virtual void clear() = 0;
    /// Adds a hit, unless it does not see the light itself: it may see less of it than the point that it shares.
    virtual bool add(const Hits& hits, std::size_t hit) = 0;
    /// The rays pushed from now on are those of the hit that was added as number `index`. first: of a group.
    virtual void aim(const Hits& hits, std::size_t hit, std::size_t index, bool first) = 0;
    /// Whether it draws points for the hit at hand where rays before have found it open, see SkyGuide.
    virtual bool is_guided() const { return false; }
    /// Whether it draws points of its own.
    virtual bool draws() const = 0;
    /// Pushes the rays to its points that belong to points of the unit square, whose arrays go on to a multiple of
    /// kRaysAtOnce.
    virtual void draw(const float* u, const float* v, std::uint32_t count, DrawnRays& rays) = 0;
    /// Whether rays in directions that a lobe reflects may meet it.
    virtual bool may_meet(const LobeShape& lobe, const Vec3d& view) const = 0;
    /// Pushes the rays in directions of the shading frame, at most kRaysAtOnce, that meet it. kind: of the lobe that
    /// has drawn them.
    virtual void meet(const RayVectors& directions, std::uint32_t count, RayKind kind, DrawnRays& rays) = 0;
    /// Finds what the rays see of it.
    virtual void trace(ShadowTracer& tracer, DrawnRays& rays) = 0;
    /// Radiance by which the rays' is multiplied.
    virtual Rgb strength() const = 0;
    /// Completes the light's density and colour of some rays.
    virtual void find_radiance(std::span<const std::size_t> some, DrawnRays& rays) = 0;
    /// To be called after find_radiance: makes the light's density that of a guided hit.
    virtual void guide(std::span<const std::size_t> /*some*/, DrawnRays& /*rays*/) const {}
};

/// A light with extent.
class LightTarget : public ShadowTarget {
  public:
    void set(const Light& light) { light_ = &light; }

    void clear() override { whole_.clear(); }
    bool add(const Hits& hits, std::size_t hit) override;
    void aim(const Hits& hits, std::size_t hit, std::size_t index, bool first) override;
    bool draws() const override { return true; }
    void draw(const float* u, const float* v, std::uint32_t count, DrawnRays& rays) override;
    bool may_meet(const LobeShape& lobe, const Vec3d& view) const override;
    void meet(const RayVectors& directions, std::uint32_t count, RayKind kind, DrawnRays& rays) override;
    void trace(ShadowTracer& tracer, DrawnRays& rays) override;
    Rgb strength() const override;
    void find_radiance(std::span<const std::size_t>, DrawnRays&) override {}

  private:
    double solid_angle() const;
    void draw_rectangle(const float* u, const float* v, std::uint32_t count, DrawnRays& rays);
    void draw_point(const glm::dvec2& point, DrawnRays& rays);
    void push(const Vec3d& direction, double distance, double weight, DrawnRays& rays) const;
    void push(const FaceSample& sample, DrawnRays& rays) const;
    void push(const LightPointArrays& points, std::uint32_t count, DrawnRays& rays) const;
    void follow(const MeshLight& mesh, ShadowTracer& tracer, DrawnRays& rays);

    const Light* light_ = nullptr;
    std::vector<std::optional<WholeRectangle>> whole_;  // as each hit sees it, or else …
    std::vector<LocalLight> seen_;                      // … the light; may be longer
    LightSampler sampler_;
    FaceSampler face_sampler_;
    std::vector<RayHit> met_;          // by the rays: opaque surfaces
    std::vector<Rgb> passed_, sheer_;  // by the rays: share of light that surfaces before let through, faces seen

    // The hit that rays are drawn from:
    const ShadingFrame* frame_ = nullptr;
    const WholeRectangle* rectangle_ = nullptr;
    bool has_faces_ = false;
    const ProfileView* profile_ = nullptr;
    std::optional<ShadowRaySpawner> start_;
};

/// The environment, which all hits see. As in Cycles, its rays that lobes draw meet what is seen by rays of the lobe's
/// kind, and of an environment of one colour there are no others.
class EnvironmentTarget : public ShadowTarget {
  public:
    /// guide: may be null.
    EnvironmentTarget(const Environment& environment, const SkyGuide* guide)
        : environment_(&environment), guide_(guide) {}

    void clear() override { reach_ = 0; }
    bool add(const Hits&, std::size_t) override { return true; }
    void aim(const Hits& hits, std::size_t hit, std::size_t index, bool first) override;
    bool is_guided() const override { return is_guided_; }
    bool draws() const override { return environment_->map() != nullptr; }
    void draw(const float* u, const float* v, std::uint32_t count, DrawnRays& rays) override;
    bool may_meet(const LobeShape&, const Vec3d&) const override { return true; }
    void meet(const RayVectors& directions, std::uint32_t count, RayKind kind, DrawnRays& rays) override;
    void trace(ShadowTracer& tracer, DrawnRays& rays) override;
    Rgb strength() const override;
    void find_radiance(std::span<const std::size_t> some, DrawnRays& rays) override;
    void guide(std::span<const std::size_t> some, DrawnRays& rays) const override;

  private:
    void push(const Vec3d& direction, float factor, std::uint32_t kinds, DrawnRays& rays) const;

    const Environment* environment_;
    const SkyGuide* guide_;
    glm::dmat3 to_map_{1};                 // from the shading frame of the hit that rays are drawn from
    const ShadingFrame* frame_ = nullptr;  // of this hit
    std::optional<ShadowRaySpawner> start_;
    // This is the same for hits nearby:
    bool is_guided_ = false;
    GuidedDensity density_{};
    Vec3d position_{0}, normal_{0};
    double reach_ = 0;
};

}  // namespace shlight
