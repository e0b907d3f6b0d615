// SPDX-License-Identifier: MIT
//
// Direct light at surface hits, with shadows: hits in, radiance out. Hits may come from any list of rays. They come in
// groups: those of a group share shading points and shadow rays, and a seed.
//
// The light of all lamps and of the environment is found without shadows first. What it makes of a group's brightness
// is the budget by which every light, of whatever kind, gets its shadow rays.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "environment/environment_shading.h"
#include "lights/delta_lights.h"
#include "lobes/material_lobes.h"
#include "shading/direct_light.h"
#include "shading/far_light_sum.h"
#include "shading/far_lights.h"
#include "shading/shading_points.h"
#include "shadows/shadow_budget.h"
#include "shadows/shadow_policy.h"
#include "shadows/shadowed_deltas.h"
#include "shadows/shadowed_environment.h"
#include "shadows/shadowed_far_lights.h"
#include "shadows/shadowed_light.h"
#include "shlight/environment.h"
#include "shlight/light.h"
#include "shlight/render_report.h"
#include "tracing/hits.h"
#include "tracing/shadow_tracer.h"

namespace shlight {

/// The lights and materials of a scene, prepared for DirectLighting. Any number of threads may read it.
struct LightingScene {
    /// lights: those with extent first; order, tolerance: of RenderSettings. All but lobes must outlive this.
    LightingScene(std::span<const Light> lights, std::size_t extended_count, const Environment& environment,
                  std::uint32_t environment_group, std::vector<MaterialLobes> lobes, int order, double tolerance);

    std::span<const Light> lights;
    std::span<const Light> extended;
    DeltaLights deltas;
    const Environment* environment;
    std::uint32_t environment_group;
    std::vector<MaterialLobes> materials;
    std::size_t lobe_stride = 1;  ///< lobes of any material, at most
    double tolerance;
    double light_error = 0;  ///< see DirectLight::compute
    FarLights far;
    std::optional<EnvironmentShading> environment_shading;  ///< none: the environment is black
};

/// Keeps its memory from call to call; one per thread.
class DirectLighting {
  public:
    /// parts: which the hits keep apart.
    DirectLighting(const LightingScene& scene, const SceneRays& rays, std::uint32_t transparent_bounces,
                   const LightParts& parts);
    // The parts refer to each other.
    DirectLighting(const DirectLighting&) = delete;
    DirectLighting& operator=(const DirectLighting&) = delete;
    ~DirectLighting() = default;

    /// Adds what the lights bring to the radiance and noise of the hits, and what that takes to the report. seeds: one
    /// of each group; samples: which rays of each group the hits belong to.
    void add(std::span<const std::uint32_t> seeds, const SampleRange& samples, Hits& hits, RenderReport& report);

  private:
    /// Sums up the dimmest lights; the others are shaded one by one.
    void sort_lights();
    /// Light of all kinds but sources without extent, whose shadows are found along with it.
    void find_unshadowed(const Hits& hits, RenderReport& report);
    void add_shadowed(std::span<const std::uint32_t> seeds, const SampleRange& samples, Hits& hits,
                      RenderReport& report);
    /// One seed of each group for a kind of light.
    std::span<const std::uint32_t> seeds_of(std::span<const std::uint32_t> seeds, std::uint32_t kind);

    const LightingScene* scene_;
    ShadowTracer tracer_;
    ShadingPoints points_;
    FarLightSum far_light_sum_;
    std::vector<const Light*> lights_;      // with extent, that are not summed up
    std::vector<const Light*> delta_list_;  // likewise, without
    std::optional<DeltaLights> deltas_;     // of these; none: all
    DirectLight unshadowed_;
    std::vector<DirectLightParts> environment_;
    ShadowBudget budget_;
    std::size_t sum_index_ = 0, environment_index_ = 0;  // in the budget
    ShadowedFarLights shadowed_far_lights_;
    ShadowedDeltas shadowed_deltas_;
    ShadowedLight shadowed_;
    ShadowedEnvironment shadowed_environment_;
    std::vector<std::uint32_t> seeds_;
};

}  // namespace shlight
