// SPDX-License-Identifier: MIT
#include "shadows/shadowed_far_lights.h"

#include <algorithm>
#include <cmath>

#include "base/ray_rounding.h"
#include "shadows/ray_start.h"
#include "shadows/shadow_policy.h"
#include "shlight/sampling.h"

namespace shlight {
namespace {

/// Of a pixel.
constexpr std::size_t kLeastQuestions = 8;

}  // namespace

ShadowedFarLights::ShadowedFarLights(ShadowTracer& tracer, std::span<const MaterialLobes> materials,
                                     std::span<const Light> lights)
    : rays_(tracer), materials_(materials), lights_(lights) {}

void ShadowedFarLights::add(const FarLightSum& far_light_sum, const ShadingPoints& points, const SampleRange& samples,
                            const ShadowBudget& budget, std::size_t index, std::span<const std::uint32_t> pixel_seeds,
                            Hits& hits) {
    for (std::size_t pixel = 0; pixel < hits.pixel_count(); ++pixel) {
        const std::size_t hit_count = hits.pixel_begin[pixel + 1] - hits.pixel_begin[pixel];
        const float own = budget.of_group(index, pixel);
        if (!(own > 0)) {
            continue;
        }
        const float wanted = budget.rays(own, pixel, samples) * static_cast<float>(hit_count);
        const std::size_t questions = std::max(static_cast<std::size_t>(std::ceil(wanted)), kLeastQuestions);
        rays_.start();
        if (samples.shadow_rays > 0) {
            ask(far_light_sum, questions, pixel_seeds[pixel], pixel, hits);
        } else {
            rays_.know(Rgb(1), 0);
        }
        rays_.trace();
        const SharedRays::Share share = rays_.share(0, rays_.count());
        Rgb sum(0);
        for (std::size_t point = points.pixel_begin[pixel]; point < points.pixel_begin[pixel + 1]; ++point) {
            for (const std::size_t hit : points.hits_of(point)) {
                hits.radiance[hit] += share.seen * far_light_sum.radiance(point);
                sum += far_light_sum.radiance(point);
            }
        }
        if (!hits.apart.empty()) {
            find_apart(far_light_sum, points, pixel, hits.apart.parts());
            rays_.keep_apart({pixel, 0, rays_.count()}, share, apart_, hits.apart);
        }
        hits.add_shared(pixel, share.variance * sum * sum, share.obstructed);
    }
}

void ShadowedFarLights::ask(const FarLightSum& far_light_sum, std::size_t questions, std::uint32_t seed,
                            std::size_t pixel, const Hits& hits) {
    const std::size_t first = hits.pixel_begin[pixel];
    const auto count = static_cast<double>(hits.pixel_begin[pixel + 1] - first);
    for (std::size_t i = 0; i < questions; ++i) {
        const glm::dvec2 place = lattice_point(i, questions, seed);
        const std::size_t drawn = far_light_sum.find(place.x);
        const FarLight& light = far_light_sum.light(drawn);
        const auto hit = static_cast<std::size_t>(place.y * count);
        const float own = value(light, hits, first, hit) / static_cast<float>(far_light_sum.density(drawn));
        if (own > 0 && light.casts_shadows) {
            rays_.ask(Rgb(own), light.group, ray(light, hits, first + hit));
        } else if (own > 0) {
            rays_.know(Rgb(own), light.group);
        }
    }
}

/// Light by light, and then what makes up for what the sum is off by.
void ShadowedFarLights::find_apart(const FarLightSum& far_light_sum, const ShadingPoints& points, std::size_t pixel,
                                   const LightParts& parts) {
    apart_.assign(parts.count, Rgb(0));
    for (std::size_t point = points.pixel_begin[pixel]; point < points.pixel_begin[pixel + 1]; ++point) {
        point_apart_.assign(parts.count, Rgb(0));
        const std::uint32_t material = points.material[point];
        const double cosine = points.cos_theta_o[point];
        const Vec3d view(std::sqrt(1 - cosine * cosine), 0, cosine);
        for (std::size_t i = 0; i < far_light_sum.size(); ++i) {
            const FarLight& light = far_light_sum.light(i);
            const Vec3d way = light.position - points.frame[point].origin;
            const Vec3d direction = glm::normalize(points.frame[point].to_local(way));
            const Rgb irradiance = light.intensity * static_cast<float>(light.irradiance(way));
            for (std::size_t lobe = 0; lobe < materials_[material].lobes().size(); ++lobe) {
                const LobeShape shape = materials_[material].shape(lobe, points.widths(point)[lobe]);
                const Rgb own =
                    points.weight(point, lobe) * irradiance * static_cast<float>(lobe_value(shape, direction, view));
                point_apart_[LightParts::of_kind(parts.kind(material, lobe))] += own;
                point_apart_[LightParts::of_group(light.group)] += own;
            }
        }
        const std::span<Rgb> own(point_apart_);
        complete(own.first(kLightKinds), far_light_sum.radiance(point), LightParts::of_kind(LightKind::diffuse));
        complete(own.subspan(kLightKinds), far_light_sum.radiance(point), far_light_sum.light(0).group);
        for (std::size_t part = 0; part < parts.count; ++part) {
            apart_[part] += static_cast<float>(points.hit_count(point)) * own[part];
        }
    }
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
