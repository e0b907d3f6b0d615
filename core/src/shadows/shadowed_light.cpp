// SPDX-License-Identifier: MIT
#include "shadows/shadowed_light.h"

#include <algorithm>

namespace shlight {

ShadowedLight::ShadowedLight(const ShadowTracer& tracer, std::uint32_t most_rays,
                             std::span<const MaterialLobes> materials, std::size_t lobe_stride)
    : materials_(materials),
      lobe_stride_(lobe_stride),
      most_rays_(most_rays),
      rays_(tracer, materials, lobe_stride),
      brightness_(lobe_stride),
      dim_(brightness_, lobe_stride) {}

void ShadowedLight::start(const ShadingPoints& points, std::span<const float> brightness) {
    points_ = &points;
    brightness_.start(points, brightness);
    dim_.start(points);
}

void ShadowedLight::add(const Light& light, std::size_t index, const SampleRange& samples,
                        const LightRadiance& unshadowed, std::span<const std::uint32_t> pixel_seeds, Hits& hits) {
    samples_ = samples;
    unshadowed_ = unshadowed;
    shadows_ = samples.shadow_rays > 0 && traits_of(light).casts_shadows;
    for (std::size_t pixel = 0; pixel < hits.pixel_count(); ++pixel) {
        const float own = brightness_.of_pixel(index, pixel);
        if (!(own > 0)) {
            continue;
        }
        const std::size_t begin = hits.pixel_begin[pixel];
        const std::size_t end = hits.pixel_begin[pixel + 1];
        const std::size_t asked = hits_to_ask(own, brightness_.all(pixel), end - begin);
        if (shadows_ && asked < end - begin) {
            dim_.add(light, unshadowed, pixel, own, first_phase(samples, most_rays_), asked, pixel_seeds[pixel], hits,
                     rays_);
        } else {
            add_pixel(light, pixel_seeds[pixel], begin, end, hits);
        }
    }
}

void ShadowedLight::find_lit(const Light& light, const Hits& hits, std::size_t begin, std::size_t end) {
    lit_.clear();
    for (std::size_t hit = begin; hit < end; ++hit) {
        bool any = false;
        for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
            any = any || unshadowed(hit, lobe) > 0;
        }
        if (any && lit_.add(light, hits, hit)) {
            for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
                lit_.shines.push_back(unshadowed(hit, lobe) > 0 ? 1 : 0);
            }
        }
    }
}

bool ShadowedLight::is_glossy(std::uint32_t material) const {
    const auto lobes = materials_[material].lobes();
    return std::any_of(lobes.begin(), lobes.end(), [](const Lobe& lobe) { return shlight::is_glossy(lobe.shape); });
}

void ShadowedLight::add_pixel(const Light& light, std::uint32_t seed, std::size_t begin, std::size_t end, Hits& hits) {
    find_lit(light, hits, begin, end);
    if (lit_.hit.empty()) {
        return;
    }
    if (shadows_) {
        const RayPhase first = first_phase(samples_, most_rays_);
        rays_.trace(light, hits, lit_, first, seed);
        // Few rays may miss the part of a light that is seen, and a glossy lobe may have its peak there.
        if (rays_.count() > 0 && rays_.blocked_count() == rays_.count() && !is_glossy(hits.material[lit_.hit[0]])) {
            return;
        }
        if (!rays_.all_free()) {
            rays_.trace(light, hits, lit_, second_phase(samples_, first), seed);
            shade(hits);
            return;
        }
    }
    shade_unblocked(hits);
}

Rgb ShadowedLight::scaled_radiance(const Hits& hits, std::size_t hit, std::size_t lobe) const {
    return hits.weight(hit, lobe) * unshadowed_[lobe * points_->size() + points_->of_hit[hit]];
}

void ShadowedLight::shade_unblocked(Hits& hits) const {
    for (std::size_t i = 0; i < lit_.hit.size(); ++i) {
        for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
            if (shines(i, lobe)) {
                hits.radiance[lit_.hit[i]] += scaled_radiance(hits, lit_.hit[i], lobe);
            }
        }
    }
}

void ShadowedLight::shade(Hits& hits) {
    deviation_.assign(lit_.hit.size(), Rgb(0));
    for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
        shade_lobe(lobe, hits);
    }
    for (std::size_t i = 0; i < lit_.hit.size(); ++i) {
        hits.noise[lit_.hit[i]] += deviation_[i] * deviation_[i];
    }
}

void ShadowedLight::shade_lobe(std::size_t lobe, Hits& hits) {
    const auto [first, last] = std::minmax_element(lit_.hit.begin(), lit_.hit.end(), [&](std::size_t a, std::size_t b) {
        return points_->of_hit[a] < points_->of_hit[b];
    });
    const std::uint32_t first_point = points_->of_hit[*first];
    hit_sums_.assign(lit_.hit.size(), {});
    point_sums_.assign(points_->of_hit[*last] - first_point + 1, {});
    for (std::size_t i = 0; i < lit_.hit.size(); ++i) {
        if (!shines(i, lobe)) continue;
        hit_sums_[i] = rays_.sum(hits, lit_, i, lobe);
        PointSums& of_point = point_sums_[points_->of_hit[lit_.hit[i]] - first_point];
        of_point.all += hit_sums_[i].all;
        ++of_point.hits;
    }
    for (std::size_t i = 0; i < lit_.hit.size(); ++i) {
        if (!shines(i, lobe)) continue;
        const std::size_t hit = lit_.hit[i];
        const RaySums& sums = hit_sums_[i];
        const PointSums& of_point = point_sums_[points_->of_hit[hit] - first_point];
        const Vec3d share = quotient(static_cast<double>(of_point.hits) * sums.seen, of_point.all);
        const Rgb unblocked = scaled_radiance(hits, hit, lobe);
        hits.radiance[hit] += unblocked * Rgb(share);
        // The lobes of a hit share its rays.
        deviation_[i] += deviation(unblocked, sums);
    }
}

}  // namespace shlight
