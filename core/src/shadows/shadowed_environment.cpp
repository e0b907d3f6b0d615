// SPDX-License-Identifier: MIT
#include "shadows/shadowed_environment.h"

#include <algorithm>
#include <cmath>

namespace shlight {
namespace {

/// How much of what is known of the light without obstacles is put in the place of what the rays make of it: the
/// regression of what they see on it. Never so much that a sum could be negative.
Vec3d kept_share(const RaySums& sums, const Vec3d& otherwise) {
    const Vec3d share = glm::min(quotient(sums.seen_squares, sums.squares), quotient(sums.seen, sums.all));
    return glm::mix(otherwise, share, Vec3d(glm::greaterThan(sums.all, Vec3d(0))));
}

/// What is seen of the light without obstacles, by the mean over a hit's rays, as many as these of each set.
Rgb seen_part(const Rgb& unblocked, const RaySums& of_hit, const Vec3d& kept, double rays) {
    return Rgb(of_hit.seen / rays + kept * (Vec3d(unblocked) - of_hit.all / rays));
}

}  // namespace

ShadowedEnvironment::ShadowedEnvironment(ShadowTracer& tracer, const Environment& environment,
                                         std::span<const MaterialLobes> materials)
    : materials_(materials), rays_(tracer, environment, materials) {}

void ShadowedEnvironment::add(const EnvironmentShading& shading, std::uint32_t group,
                              std::span<const UnshadowedParts> unshadowed, const ShadingPoints& points,
                              const ShadowBudget& budget, std::size_t index, const SampleRange& samples,
                              std::span<const std::uint32_t> seeds, Hits& hits) {
    shading_ = &shading;
    group_ = group;
    unshadowed_ = unshadowed;
    points_ = &points;
    const bool shadows = samples.shadow_rays > 0;
    for (std::size_t pixel = 0; pixel < hits.pixel_count(); ++pixel) {
        const LitRange range = budget.of_group(index, pixel) > 0 ? find_lit(hits, pixel) : LitRange{0, 0};
        if (range.size() > 0) {
            pixels_.push_back({range, pixel, budget.samples_of(index, pixel, samples), seeds[pixel]});
        }
        if (lit_.size() >= kHitsAtOnce) {
            shade_lit(shadows, hits);
        }
    }
    shade_lit(shadows, hits);
}

UnshadowedParts ShadowedEnvironment::unblocked(const Hits& hits, std::size_t hit, std::size_t lobe) const {
    const Rgb& weight = hits.weight(hit, lobe);
    const UnshadowedParts& parts = unshadowed_[lobe * points_->size() + points_->of_hit[hit]];
    return {weight * parts.smooth, weight * parts.spots};
}

LitRange ShadowedEnvironment::find_lit(const Hits& hits, std::size_t pixel) {
    const std::size_t begin = lit_.size();
    for (std::size_t hit = hits.pixel_begin[pixel]; hit < hits.pixel_begin[pixel + 1]; ++hit) {
        if (!materials_[hits.material[hit]].lobes().empty()) {
            lit_.push_back(hit);
        }
    }
    return {begin, lit_.size()};
}

void ShadowedEnvironment::shade_lit(bool shadows, Hits& hits) {
    rays_.start(hits, lit_);
    for (const LitPixel& pixel : shadows ? std::span(pixels_) : std::span<const LitPixel>()) {
        rays_.draw(pixel.range, pixel.samples, pixel.seed);
    }
    rays_.trace();
    partly_.clear();
    for (const LitPixel& pixel : pixels_) {
        if (shadows && rays_.any_occluded(pixel.range)) {
            hits.obstructed[pixel.pixel] = 1;
            partly_.push_back(pixel);
            rays_.weigh(pixel.range);
        } else {
            shade_unblocked(pixel.range, hits);
        }
    }
    rays_.find_weights();
    for (const LitPixel& pixel : partly_) {
        shade(pixel, hits);
    }
    pixels_.clear();
    lit_.clear();
}

void ShadowedEnvironment::shade_unblocked(const LitRange& pixel, Hits& hits) const {
    for (std::size_t i = pixel.begin; i < pixel.end; ++i) {
        for (std::size_t lobe = 0; lobe < materials_[hits.material[lit_[i]]].lobes().size(); ++lobe) {
            const UnshadowedParts whole = unblocked(hits, lit_[i], lobe);
            hits.reflect(lit_[i], lobe, group_, whole.smooth + whole.spots);
        }
    }
}

void ShadowedEnvironment::shade(const LitPixel& pixel, Hits& hits) {
    const LitRange& range = pixel.range;
    std::size_t lobe_count = 0;
    for (std::size_t i = range.begin; i < range.end; ++i) {
        lobe_count = std::max(lobe_count, materials_[hits.material[lit_[i]]].lobes().size());
    }
    deviation_.assign(range.size(), Rgb(0));
    for (std::size_t lobe = 0; lobe < lobe_count; ++lobe) {
        shade_lobe(pixel, lobe, hits);
    }
    for (std::size_t i = 0; i < range.size(); ++i) {
        hits.noise[lit_[range.begin + i]] += deviation_[i] * deviation_[i];
    }
}

void ShadowedEnvironment::shade_lobe(const LitPixel& pixel, std::size_t lobe, Hits& hits) {
    const auto lit_hits = std::span(lit_).subspan(pixel.range.begin, pixel.range.size());
    const auto material_of = [&](std::size_t i) -> std::size_t { return hits.material[lit_hits[i]]; };
    const auto has_lobe = [&](std::size_t i) { return lobe < materials_[material_of(i)].lobes().size(); };
    hit_sums_.assign(lit_hits.size(), {});
    material_sums_.clear();
    for (std::size_t i = 0; i < lit_hits.size(); ++i) {
        if (has_lobe(i)) {
            const std::size_t hit = lit_hits[i];
            const bool split = shading_->splits(material_of(i), lobe, hits.widths(hit)[lobe]);
            hit_sums_[i] = rays_.sum(pixel.range.begin + i, lobe, split);
            const Vec3d weight(hits.weight(hit, lobe));
            hit_sums_[i].smooth *= weight;
            hit_sums_[i].spots *= weight;
            EnvironmentRays::Sums& sums = sums_of(material_of(i)).sums;
            sums.smooth += hit_sums_[i].smooth;
            sums.spots += hit_sums_[i].spots;
        }
    }
    for (MaterialSums& material : material_sums_) {
        material.kept_smooth = kept_share(material.sums.smooth, Vec3d(1));
        // Spots that no ray has met are taken to be as hidden as the rest.
        material.kept_spots = kept_share(material.sums.spots, material.kept_smooth);
    }
    for (std::size_t i = 0; i < lit_hits.size(); ++i) {
        if (has_lobe(i)) {
            deviation_[i] +=
                shade_hit(lit_hits[i], lobe, hit_sums_[i], sums_of(material_of(i)), pixel.samples.shadow_rays, hits);
        }
    }
}

ShadowedEnvironment::MaterialSums& ShadowedEnvironment::sums_of(std::size_t material) {
    const auto known = std::find_if(material_sums_.begin(), material_sums_.end(),
                                    [&](const MaterialSums& sums) { return sums.material == material; });
    return known != material_sums_.end() ? *known : material_sums_.emplace_back(MaterialSums{material, {}, {}, {}});
}

Rgb ShadowedEnvironment::shade_hit(std::size_t hit, std::size_t lobe, const EnvironmentRays::Sums& of_hit,
                                   const MaterialSums& of_material, double rays, Hits& hits) const {
    const UnshadowedParts whole = unblocked(hits, hit, lobe);
    if (is_mirror(materials_[hits.material[hit]].lobes()[lobe].shape)) {
        // One ray, that is all of its light.
        hits.reflect(hit, lobe, group_, whole.smooth * Rgb(quotient(of_hit.smooth.seen, of_hit.smooth.all)));
        return Rgb(0);
    }
    hits.reflect(hit, lobe, group_, seen_part(whole.smooth, of_hit.smooth, of_material.kept_smooth, rays));
    hits.reflect(hit, lobe, group_, seen_part(whole.spots, of_hit.spots, of_material.kept_spots, rays));
    const auto share = [](const RaySums& sums) { return quotient(sums.seen, sums.all); };
    return deviation(whole.smooth, share(of_material.sums.smooth), of_hit.smooth) +
           deviation(whole.spots, share(of_material.sums.spots), of_hit.spots);
}

}  // namespace shlight
