// SPDX-License-Identifier: MIT
#include "shadows/shadowed_light.h"

#include <algorithm>
#include <cmath>

#include "shlight/sampling.h"

namespace shlight {

ShadowedLight::ShadowedLight(ShadowTracer& tracer, const ShadowBudget& budget, std::span<const MaterialLobes> materials,
                             std::size_t lobe_stride, const LightParts& parts)
    : materials_(materials),
      lobe_stride_(lobe_stride),
      budget_(&budget),
      rays_(tracer, materials, lobe_stride),
      shared_(tracer, budget, materials, lobe_stride, parts) {}

void ShadowedLight::add(std::span<const Light* const> lights, const UnshadowedRadiance& unshadowed,
                        const ShadingPoints& points, const SampleRange& samples, std::span<const std::uint32_t> seeds,
                        Hits& hits) {
    points_ = &points;
    samples_ = samples;
    shared_.start(lights, unshadowed, samples);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        unshadowed_ = unshadowed.light(i);
        shadows_ = samples.shadow_rays > 0 && traits_of(*lights[i]).casts_shadows;
        group_ = traits_of(*lights[i]).group;
        add_light(*lights[i], i, seeds, hits);
    }
    shared_.add(points, seeds, hits);
}

void ShadowedLight::add_light(const Light& light, std::size_t index, std::span<const std::uint32_t> seeds, Hits& hits) {
    for (std::size_t pixel = 0; pixel < hits.pixel_count(); ++pixel) {
        if (!(budget_->of_group(index, pixel) > 0) || shared_.is_dim(index, pixel)) {
            continue;
        }
        const LitRange range = find_lit(light, hits, pixel);
        if (range.size() > 0) {
            const std::uint32_t seed = hash(seeds[pixel], static_cast<std::uint32_t>(index));
            pixels_.push_back({range, pixel, budget_->samples_of(index, pixel, samples_), seed});
        }
        if (lit_.hit.size() >= kHitsAtOnce) {
            shade_lit(light, hits);
        }
    }
    shade_lit(light, hits);
}

LitRange ShadowedLight::find_lit(const Light& light, const Hits& hits, std::size_t pixel) {
    const std::size_t begin = lit_.hit.size();
    for (std::size_t hit = hits.pixel_begin[pixel]; hit < hits.pixel_begin[pixel + 1]; ++hit) {
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
    return {begin, lit_.hit.size()};
}

void ShadowedLight::shade_lit(const Light& light, Hits& hits) {
    rays_.start(light, hits, lit_);
    for (const LitPixel& pixel : shadows_ ? std::span(pixels_) : std::span<const LitPixel>()) {
        rays_.draw(pixel.range, pixel.samples, pixel.seed);
    }
    rays_.trace();
    for (const LitPixel& pixel : pixels_) {
        if (!shadows_ || !rays_.any_occluded(pixel.range)) {
            shade_unblocked(pixel.range, hits);
        } else {
            hits.obstructed[pixel.pixel] = 1;
            shade(pixel.range, hits);
        }
    }
    pixels_.clear();
    lit_.clear();
}

Rgb ShadowedLight::scaled_radiance(const Hits& hits, std::size_t hit, std::size_t lobe) const {
    return hits.weight(hit, lobe) * unshadowed_[lobe * points_->size() + points_->of_hit[hit]];
}

void ShadowedLight::shade_unblocked(const LitRange& pixel, Hits& hits) const {
    for (std::size_t i = pixel.begin; i < pixel.end; ++i) {
        for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
            if (shines(i, lobe)) {
                hits.reflect(lit_.hit[i], lobe, group_, scaled_radiance(hits, lit_.hit[i], lobe));
            }
        }
    }
}

void ShadowedLight::shade(const LitRange& pixel, Hits& hits) {
    deviation_.assign(pixel.size(), Rgb(0));
    for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
        shade_lobe(pixel, lobe, hits);
    }
    for (std::size_t i = 0; i < pixel.size(); ++i) {
        hits.noise[lit_.hit[pixel.begin + i]] += deviation_[i] * deviation_[i];
    }
}

void ShadowedLight::shade_lobe(const LitRange& pixel, std::size_t lobe, Hits& hits) {
    const auto lit_hits = std::span(lit_.hit).subspan(pixel.begin, pixel.size());
    hit_sums_.assign(lit_hits.size(), {});
    material_sums_.clear();
    for (std::size_t i = 0; i < lit_hits.size(); ++i) {
        if (!shines(pixel.begin + i, lobe)) continue;
        hit_sums_[i] = rays_.sum(pixel.begin + i, lobe);
        MaterialSums& sums = sums_of(hits, lit_hits[i], lobe);
        sums.unblocked += Vec3d(scaled_radiance(hits, lit_hits[i], lobe));
        const Vec3d weight(glm::abs(hits.weight(lit_hits[i], lobe)));
        sums.rays += weight * hit_sums_[i].all;
        sums.seen += weight * hit_sums_[i].seen;
    }
    for (std::size_t i = 0; i < lit_hits.size(); ++i) {
        if (!shines(pixel.begin + i, lobe)) continue;
        const MaterialSums& all = sums_of(hits, lit_hits[i], lobe);
        const Vec3d seen = Vec3d(glm::abs(hits.weight(lit_hits[i], lobe))) * hit_sums_[i].seen;
        hits.reflect(lit_hits[i], lobe, group_, Rgb(all.unblocked * quotient(seen, all.rays)));
        // The lobes of a hit share its rays.
        deviation_[i] +=
            deviation(scaled_radiance(hits, lit_hits[i], lobe), quotient(all.seen, all.rays), hit_sums_[i]);
    }
}

ShadowedLight::MaterialSums& ShadowedLight::sums_of(const Hits& hits, std::size_t hit, std::size_t lobe) {
    const std::uint32_t material = hits.material[hit];
    // A mirror's one ray does not tell of other hits.
    const bool is_apart = is_mirror(materials_[material].shape(lobe, hits.widths(hit)[lobe]));
    const auto known = std::find_if(material_sums_.begin(), material_sums_.end(), [&](const MaterialSums& sums) {
        return sums.material == material && (!is_apart || sums.hit == hit);
    });
    return known != material_sums_.end() ? *known
                                         : material_sums_.emplace_back(MaterialSums{material, hit, {}, {}, {}});
}

}  // namespace shlight
