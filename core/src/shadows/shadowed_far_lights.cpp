// SPDX-License-Identifier: MIT
#include "shadows/shadowed_far_lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/ray_rounding.h"
#include "shadows/ray_start.h"
#include "shadows/shadow_policy.h"
#include "shlight/sampling.h"

namespace shlight {
namespace {

/// Of a pixel.
constexpr std::size_t kLeastQuestions = 8;
constexpr std::size_t kMostQuestions = 1024;

/// The golden ratio's: its multiples are spread evenly, however many there are.
constexpr double kLatticeStep = std::numbers::phi - 1;

/// 0 … 1, 1 excluded.
double unit(std::uint32_t random) {
    return random * 0x1p-32;
}

/// The variance of their sum, over that of all light, is then a quarter of what shadow_policy.h allows, as long as it
/// is less than half of that light.
std::size_t lights_to_ask(float share, std::size_t hits, std::size_t lights) {
    const auto wanted = static_cast<std::size_t>(std::ceil(4 * share * share / kDimShare * static_cast<float>(hits)));
    return std::clamp(wanted, kLeastQuestions, std::clamp(lights, kLeastQuestions, kMostQuestions));
}

}  // namespace

ShadowedFarLights::ShadowedFarLights(const ShadowTracer& tracer, std::span<const MaterialLobes> materials,
                                     std::span<const Light> lights)
    : tracer_(&tracer), materials_(materials), lights_(lights) {}

void ShadowedFarLights::add(const FarLightSum& far_light_sum, const ShadingPoints& points, bool shadows,
                            std::span<const std::uint32_t> pixel_seeds, std::span<const float> brightness, Hits& hits) {
    for (std::size_t pixel = 0; pixel < hits.pixel_count(); ++pixel) {
        const std::size_t hit_count = hits.pixel_begin[pixel + 1] - hits.pixel_begin[pixel];
        const float own = far_light_sum.brightness(pixel);
        if (!(own > 0)) {
            continue;
        }
        const std::size_t questions = lights_to_ask(own / brightness[pixel], hit_count, far_light_sum.size());
        const Rgb seen = shadows ? find_share(far_light_sum, questions, pixel_seeds[pixel], pixel, hits) : Rgb(1);
        for (std::size_t point = points.pixel_begin[pixel]; point < points.pixel_begin[pixel + 1]; ++point) {
            for (const std::size_t hit : points.hits_of(point)) {
                hits.radiance[hit] += seen * far_light_sum.radiance(point);
            }
        }
    }
}

Rgb ShadowedFarLights::find_share(const FarLightSum& far_light_sum, std::size_t questions, std::uint32_t seed,
                                  std::size_t pixel, const Hits& hits) {
    const std::size_t first = hits.pixel_begin[pixel];
    const auto count = static_cast<double>(hits.pixel_begin[pixel + 1] - first);
    rays_.clear();
    values_.clear();
    float all = 0;
    Rgb seen(0);
    // A lattice of rank 1 over lights and hits.
    const glm::dvec2 shift(unit(hash(seed, 0)), unit(hash(seed, 1)));
    for (std::size_t i = 0; i < questions; ++i) {
        const auto number = static_cast<double>(i);
        const glm::dvec2 place((number + shift.x) / static_cast<double>(questions),
                               glm::fract(number * kLatticeStep + shift.y));
        const std::size_t drawn = far_light_sum.find(place.x);
        const FarLight& light = far_light_sum.light(drawn);
        const auto hit = static_cast<std::size_t>(place.y * count);
        const float own = value(light, hits, first, hit) / static_cast<float>(far_light_sum.density(drawn));
        if (!(own > 0)) {
            continue;
        }
        all += own;
        if (light.casts_shadows) {
            rays_.push_back(ray(light, hits, first + hit));
            values_.push_back(own);
        } else {
            seen += Rgb(own);
        }
    }
    visible_.resize(rays_.size());
    tracer_->visibility(rays_, visible_);
    rays_traced_ += rays_.size();
    for (std::size_t i = 0; i < rays_.size(); ++i) {
        seen += visible_[i] * values_[i];
    }
    return all > 0 ? seen / all : Rgb(0);
}

float ShadowedFarLights::value(const FarLight& light, const Hits& hits, std::size_t first, std::size_t hit) const {
    const ShadingFrame& frame = hits.frame[first + hit];
    const Vec3d way = light.position - frame.origin;
    if (!(glm::dot(frame.z, way) > 0)) {
        return 0;
    }
    const Vec3d direction = glm::normalize(frame.to_local(way));
    const Rgb irradiance = glm::abs(light.intensity) * static_cast<float>(light.irradiance(way));
    const MaterialLobes& material = materials_[hits.material[first + hit]];
    float sum = 0;
    for (std::size_t lobe = 0; lobe < material.lobes().size(); ++lobe) {
        sum += glm::dot(glm::abs(hits.weight(first + hit, lobe)), irradiance) *
               static_cast<float>(
                   lobe_value(material.shape(lobe, hits.widths(first + hit)[lobe]), direction, hits.view(first + hit)));
    }
    return sum;
}

/// To the light's middle.
Ray ShadowedFarLights::ray(const FarLight& light, const Hits& hits, std::size_t hit) const {
    const Vec3f start(hits.shadow_origin[hit]);
    const Vec3d end = light.position + clearance(lights_[light.index], hits.frame[hit]);
    return {start, 0.0F, Vec3f(end - Vec3d(start)), kRayEnd};
}

}  // namespace shlight
