// SPDX-License-Identifier: MIT
//
// Direct light at surface hits, with shadows: hits in, radiance out. Hits may come from any list of rays. They come in
// groups: those of a group share shading points and shadow rays, and a seed.
//
// The light of all lamps and of the environment is found without shadows first. What it makes of a group's brightness
// is the budget by which every light, of whatever kind, gets its shadow rays.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "lighting/environment_shading.h"
#include "lighting/shading_points.h"
#include "lighting/shadow_budget.h"
#include "lighting/shadow_policy.h"
#include "lighting/shadow_targets.h"
#include "lighting/shadowed_deltas.h"
#include "lighting/shadowed_light.h"
#include "lighting/shared_shadow_lights.h"
#include "lighting/sky_guide.h"
#include "lighting/unshadowed_light.h"
#include "lighting/unshadowed_radiance.h"
#include "lights/delta_lights.h"
#include "lobes/material_lobes.h"
#include "shlight/environment.h"
#include "shlight/light.h"
#include "shlight/mesh.h"
#include "shlight/parallel.h"
#include "shlight/render_report.h"
#include "shlight/scene.h"
#include "tracing/hits.h"
#include "tracing/shadow_tracer.h"

namespace shlight {

/// order, tolerance: of RenderSettings. Lobes of microfacets are at least so wide, but for those whose width varies.
/// Throws RenderCancelled once stopped.
std::vector<MaterialLobes> lobes_of_materials(std::span<const Material> materials, int order, double tolerance,
                                              const Stopped& stopped, double least_width = 0);

/// The lights and materials of a scene, prepared for DirectLighting. Any number of threads may read it.
struct LightingScene {
    /// The scene must outlive this.
    LightingScene(const CompiledScene& scene, std::vector<MaterialLobes> lobes, int order, double error_tolerance);
    /// all: the lights, those with extent first; order, error_tolerance: of RenderSettings. All but lobes must outlive
    /// this.
    LightingScene(std::span<const Light> all, std::size_t extended_count, const Environment& sky,
                  std::uint32_t sky_group, std::vector<MaterialLobes> lobes, int order, double error_tolerance);

    /// Shades as exactly as another one.
    void follow(const LightingScene& other);
    /// Hits that should be shaded together. Under many lights fewer: what each light adds is kept until all are known.
    std::uint32_t batch_size() const;

    std::span<const Light> extended;
    DeltaLights deltas;
    const Environment* environment;
    std::uint32_t environment_group;
    std::vector<MaterialLobes> materials;
    std::size_t lobe_stride = 1;  ///< lobes of any material, at most
    double tolerance;
    double light_error = 0;                                 ///< see UnshadowedRadiance::compute
    double face_tolerance = 0;                              ///< likewise
    std::shared_ptr<const SkyGuide> sky_guide;              ///< may be null
    std::optional<EnvironmentShading> environment_shading;  ///< none: the environment is black
};

/// Some of the lights of a LightingScene.
struct LightSelection {
    std::size_t begin, end;     ///< of those with extent
    const DeltaLights* deltas;  ///< of those without, or others like them; null: none
    bool environment;
};

/// Keeps its memory from call to call; one per thread.
class DirectLighting {
  public:
    /// parts: which the hits keep apart; face_errors: times LightingScene::face_tolerance is that of these hits.
    DirectLighting(const LightingScene& scene, const SceneRays& rays, std::uint32_t transparent_bounces,
                   const LightParts& parts, double face_errors = 1);
    // The parts refer to each other.
    DirectLighting(const DirectLighting&) = delete;
    DirectLighting& operator=(const DirectLighting&) = delete;
    ~DirectLighting() = default;

    /// Adds what the lights bring to the radiance and noise of the hits, and what that takes to the report. seeds: one
    /// of each group; samples: which rays of each group the hits belong to.
    /// penumbrae: likewise, see ShadowBudget.
    void add(std::span<const std::uint32_t> seeds, std::span<const std::uint32_t> penumbrae, const SampleRange& samples,
             Hits& hits, RenderReport& report);

    // The same in steps, for callers that keep the points of hits, or the light of some lights apart.
    /// Finds the light of all lights without shadows.
    void find(const ShadingPoints& points, RenderReport& report);
    /// Shares out the shadow rays. others: brightness of each group by lights that are not among the scene's, as in
    /// ShadowBudget, or empty.
    void share_out(std::span<const std::uint32_t> penumbrae, std::span<const float> others);
    /// Adds the light of some of them to hits that have these points, after share_out().
    void add(const LightSelection& lights, std::span<const std::uint32_t> seeds, const SampleRange& samples, Hits& hits,
             RenderReport& report);
    /// Since the last find(): the lights with extent, then the environment, unless it is black.
    std::span<const UnshadowedLight> unshadowed() const { return lights_; }

  private:
    /// Light of all kinds but sources without extent, whose shadows are found along with it.
    void find_unshadowed(RenderReport& report);
    void add_extended(const LightSelection& lights, const SampleRange& samples, std::span<const std::uint32_t> seeds,
                      Hits& hits);
    /// One seed of each group for a kind of light.
    std::span<const std::uint32_t> seeds_of(std::span<const std::uint32_t> seeds, std::uint32_t kind);

    const LightingScene* scene_;
    double face_errors_;
    ShadowTracer tracer_;
    ShadingPoints own_points_;
    const ShadingPoints* points_ = nullptr;  // of the last find()
    UnshadowedRadiance unshadowed_;
    UnshadowedParts environment_;
    std::vector<UnshadowedLight> lights_;  // those with extent, then the environment, unless it is black
    ShadowBudget budget_;
    ShadowedDeltas shadowed_deltas_;
    SharedShadowLights shared_;
    ShadowedLight shadowed_;
    LightTarget light_target_;
    EnvironmentTarget environment_target_;
    std::vector<std::uint32_t> seeds_;
};

}  // namespace shlight
