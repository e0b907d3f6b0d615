// SPDX-License-Identifier: MIT
#include "lighting/direct_lighting.h"

#include <algorithm>
#include <utility>

#include "base/stage_clock.h"
#include "shlight/sampling.h"

namespace shlight {
namespace {

/// Seeds that separate the shadow rays of different kinds of lights.
constexpr std::uint32_t kLightSeed = 0;
constexpr std::uint32_t kDeltaSeed = 0xFFFFFFFEU;

/// Values of UnshadowedRadiance that a batch should hold: as many as fit the cache.
constexpr std::size_t kValues = std::size_t{1} << 21;
/// Hits of a batch: enough for long batches, few enough for the cache.
constexpr std::size_t kMostHits = 4096;
constexpr std::size_t kLeastHits = 64;

/// A lobe whose width varies has none to widen.
void widen(Lobe& lobe, double least_width) {
    const LobeForm own = lobe_form(lobe.shape);
    const LobeForm wide = widened(lobe.shape, own, least_width);
    if (lobe.varying_width == 0 && wide.width > own.width) {
        lobe.shape = with_form(lobe.shape, wide);
        lobe.fit = is_anisotropic(lobe.shape) ? nullptr : boosted_fit(lobe.shape, lobe.only_order);
    }
}

}  // namespace

std::vector<MaterialLobes> lobes_of_materials(std::span<const Material> materials, int order, double tolerance,
                                              const Stopped& stopped, double least_width) {
    std::vector<MaterialLobes> lobes;
    for (const Material& material : materials) {
        end_if(stopped);
        std::vector<Lobe> own = material.shader == nullptr ? material.bsdf.lobes() : lobes_of(*material.shader);
        for (Lobe& lobe : own) {
            widen(lobe, least_width);
        }
        lobes.emplace_back(own, order, tolerance, material.light_set);
    }
    end_if(stopped);
    return lobes;
}

LightingScene::LightingScene(const CompiledScene& scene, std::vector<MaterialLobes> lobes, int order,
                             double error_tolerance)
    : LightingScene(scene.lights(), scene.extended_light_count(), scene.environment(), scene.environment_group(),
                    std::move(lobes), order, error_tolerance) {}

LightingScene::LightingScene(std::span<const Light> all, std::size_t extended_count, const Environment& sky,
                             std::uint32_t sky_group, std::vector<MaterialLobes> lobes, int order,
                             double error_tolerance)
    : extended(all.first(extended_count)),
      deltas(all.subspan(extended_count)),
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

void LightingScene::follow(const LightingScene& other) {
    light_error = other.light_error;
    face_tolerance = other.face_tolerance;
    sky_guide = other.sky_guide;
}

std::uint32_t LightingScene::batch_size() const {
    const std::size_t values = std::max<std::size_t>(extended.size() * lobe_stride, 1);
    return static_cast<std::uint32_t>(std::clamp(kValues / values, kLeastHits, kMostHits));
}

DirectLighting::DirectLighting(const LightingScene& scene, const SceneRays& rays, std::uint32_t transparent_bounces,
                               const LightParts& parts, double face_errors)
    : scene_(&scene),
      face_errors_(face_errors),
      tracer_(rays, transparent_bounces),
      unshadowed_(scene.lobe_stride),
      budget_(scene.lobe_stride),
      shadowed_deltas_(tracer_, scene.materials, scene.lobe_stride),
      shared_(tracer_, budget_, scene.materials, scene.lobe_stride, parts),
      shadowed_(tracer_, budget_, scene.materials, scene.lobe_stride),
      environment_target_(*scene.environment, scene.sky_guide.get()) {}

void DirectLighting::add(std::span<const std::uint32_t> seeds, std::span<const std::uint32_t> penumbrae,
                         const SampleRange& samples, Hits& hits, RenderReport& report) {
    StageClock clock(report);
    own_points_.assign(hits, scene_->materials, scene_->extended, scene_->deltas, scene_->tolerance);
    clock.end(RenderStage::views);
    find(own_points_, report);
    share_out(penumbrae, {});
    add({0, scene_->extended.size(), &scene_->deltas, true}, seeds, samples, hits, report);
}

void DirectLighting::find(const ShadingPoints& points, RenderReport& report) {
    StageClock clock(report);
    points_ = &points;
    find_unshadowed(report);
    clock.end(RenderStage::light);
}

void DirectLighting::share_out(std::span<const std::uint32_t> penumbrae, std::span<const float> others) {
    budget_.start(*points_, lights_, penumbrae);
    for (std::size_t group = 0; group < others.size(); ++group) {
        budget_.all()[group] += others[group];
    }
}

void DirectLighting::add(const LightSelection& lights, std::span<const std::uint32_t> seeds, const SampleRange& samples,
                         Hits& hits, RenderReport& report) {
    StageClock clock(report);
    if (lights.deltas != nullptr && lights.deltas->padded_size() > 0) {
        shadowed_deltas_.add(*lights.deltas, *points_, samples.shadow_rays > 0,
                             seeds_of(seeds, hash(kDeltaSeed, samples.first_point)), hits, budget_.all(), report);
    }
    add_extended(lights, samples, seeds_of(seeds, kLightSeed), hits);
    clock.end(RenderStage::shadows);
    tracer_.move_to(report);
}

void DirectLighting::find_unshadowed(RenderReport& report) {
    unshadowed_.compute(*points_, scene_->materials, scene_->extended, scene_->light_error,
                        face_errors_ * scene_->face_tolerance, report);
    lights_.clear();
    for (std::size_t i = 0; i < scene_->extended.size(); ++i) {
        const LightTraits& traits = traits_of(scene_->extended[i]);
        lights_.push_back({unshadowed_.light(i), {}, traits.group, traits.casts_shadows});
    }
    if (scene_->environment_shading) {
        scene_->environment_shading->shade(*points_, environment_, report);
        lights_.push_back({{{}, Rgb(1), environment_.smooth},
                           {{}, Rgb(1), environment_.spots},
                           scene_->environment_group,
                           true,
                           &*scene_->environment_shading});
    }
}

void DirectLighting::add_extended(const LightSelection& lights, const SampleRange& samples,
                                  std::span<const std::uint32_t> seeds, Hits& hits) {
    const std::size_t count = scene_->extended.size();
    shared_.start(scene_->extended, std::span(lights_).first(count), samples, lights.begin, lights.end);
    shadowed_.start(*points_, samples, seeds);
    for (std::size_t i = lights.begin; i < lights.end; ++i) {
        light_target_.set(scene_->extended[i]);
        shadowed_.add(
            light_target_, lights_[i], i, [&](std::size_t group) { return shared_.is_dim(i, group); }, hits);
    }
    shared_.add(*points_, seeds, hits);
    if (lights.environment && lights_.size() > count) {
        shadowed_.add(
            environment_target_, lights_[count], count, [](std::size_t) { return false; }, hits);
    }
}

std::span<const std::uint32_t> DirectLighting::seeds_of(std::span<const std::uint32_t> seeds, std::uint32_t kind) {
    seeds_.resize(seeds.size());
    std::transform(seeds.begin(), seeds.end(), seeds_.begin(), [&](std::uint32_t seed) { return hash(seed, kind); });
    return seeds_;
}

}  // namespace shlight
