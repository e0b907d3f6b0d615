// SPDX-License-Identifier: MIT
#include "shadows/direct_lighting.h"

#include <algorithm>
#include <utility>

#include "base/stage_clock.h"
#include "shlight/sampling.h"

namespace shlight {
namespace {

/// Seeds that separate the shadow rays of different kinds of lights.
constexpr std::uint32_t kLightSeed = 0;
constexpr std::uint32_t kEnvironmentSeed = 0xFFFFFFFFU;
constexpr std::uint32_t kDeltaSeed = 0xFFFFFFFEU;

}  // namespace

LightingScene::LightingScene(std::span<const Light> all, std::size_t extended_count, const Environment& sky,
                             std::uint32_t sky_group, std::vector<MaterialLobes> lobes, int order,
                             double error_tolerance)
    : extended(all.first(extended_count)),
      extended_list(pointers_to(extended)),
      deltas(pointers_to(all.subspan(extended_count))),
      environment(&sky),
      environment_group(sky_group),
      materials(std::move(lobes)),
      tolerance(error_tolerance) {
    for (const MaterialLobes& material : materials) {
        lobe_stride = std::max(lobe_stride, material.lobes().size());
    }
    if (!sky.is_black()) {
        environment_shading.emplace(sky, materials, lobe_stride, order, tolerance);
    }
}

DirectLighting::DirectLighting(const LightingScene& scene, const SceneRays& rays, std::uint32_t transparent_bounces,
                               const LightParts& parts)
    : scene_(&scene),
      tracer_(rays, transparent_bounces),
      unshadowed_(scene.lobe_stride),
      budget_(scene.lobe_stride),
      shadowed_deltas_(tracer_, scene.materials, scene.lobe_stride),
      shadowed_(tracer_, budget_, scene.materials, scene.lobe_stride, parts),
      shadowed_environment_(tracer_, *scene.environment, scene.materials) {}

void DirectLighting::add(std::span<const std::uint32_t> seeds, const SampleRange& samples, Hits& hits,
                         RenderReport& report) {
    StageClock clock(report);
    points_.assign(hits, scene_->materials, scene_->extended, scene_->deltas, scene_->tolerance);
    clock.end(RenderStage::views);
    find_unshadowed(report);
    clock.end(RenderStage::light);
    add_shadowed(seeds, samples, hits, report);
    clock.end(RenderStage::shadows);
    tracer_.move_to(report);
}

void DirectLighting::find_unshadowed(RenderReport& report) {
    unshadowed_.compute(points_, scene_->materials, scene_->extended_list, scene_->light_error, report);
    budget_.start(points_, scene_->extended_list.size(), unshadowed_);
    if (scene_->environment_shading) {
        scene_->environment_shading->shade(points_, environment_, report);
        environment_index_ = budget_.add([&](std::size_t point) {
            float sum = 0;
            for (std::size_t lobe = 0; lobe < scene_->lobe_stride; ++lobe) {
                const UnshadowedParts& own = environment_[lobe * points_.size() + point];
                sum += brightness_of(points_.weight(point, lobe) * (own.smooth + own.spots));
            }
            return sum;
        });
    }
}

void DirectLighting::add_shadowed(std::span<const std::uint32_t> seeds, const SampleRange& samples, Hits& hits,
                                  RenderReport& report) {
    if (scene_->deltas.padded_size() > 0) {
        shadowed_deltas_.add(scene_->deltas, points_, samples.shadow_rays > 0,
                             seeds_of(seeds, hash(kDeltaSeed, samples.first)), hits, budget_.all(), report);
    }
    shadowed_.add(scene_->extended_list, unshadowed_, points_, samples, seeds_of(seeds, kLightSeed), hits);
    if (scene_->environment_shading) {
        shadowed_environment_.add(*scene_->environment_shading, scene_->environment_group, environment_, points_,
                                  budget_, environment_index_, samples, seeds_of(seeds, kEnvironmentSeed), hits);
    }
}

std::span<const std::uint32_t> DirectLighting::seeds_of(std::span<const std::uint32_t> seeds, std::uint32_t kind) {
    seeds_.resize(seeds.size());
    std::transform(seeds.begin(), seeds.end(), seeds_.begin(), [&](std::uint32_t seed) { return hash(seed, kind); });
    return seeds_;
}

}  // namespace shlight
