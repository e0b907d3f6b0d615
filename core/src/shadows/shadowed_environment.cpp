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

}  // namespace

ShadowedEnvironment::ShadowedEnvironment(const ShadowTracer& tracer, const Environment& environment,
                                         std::span<const MaterialLobes> materials)
    : materials_(materials), rays_(tracer, environment, materials) {}

void ShadowedEnvironment::add(const EnvironmentShading& shading, const SampleRange& samples,
                              std::span<const DirectLightParts> unshadowed, std::size_t point_count,
                              std::span<const std::uint32_t> point_of_hit, std::span<const std::uint32_t> pixel_seeds,
                              Hits& hits) {
    shading_ = &shading;
    samples_ = samples;
    unshadowed_ = unshadowed;
    point_count_ = point_count;
    point_of_hit_ = point_of_hit;
    for (std::size_t pixel = 0; pixel < hits.pixel_count(); ++pixel) {
        add_pixel(pixel_seeds[pixel], pixel, hits);
    }
}

DirectLightParts ShadowedEnvironment::unblocked(const Hits& hits, std::size_t hit, std::size_t lobe) const {
    const Rgb& weight = hits.weight(hit, lobe);
    const DirectLightParts& parts = unshadowed_[lobe * point_count_ + point_of_hit_[hit]];
    return {weight * parts.smooth, weight * parts.spots};
}

void ShadowedEnvironment::add_pixel(std::uint32_t seed, std::size_t pixel, Hits& hits) {
    lit_.clear();
    std::size_t lobe_count = 0;
    for (std::size_t hit = hits.pixel_begin[pixel]; hit < hits.pixel_begin[pixel + 1]; ++hit) {
        const std::size_t lobes = materials_[hits.material[hit]].lobes().size();
        if (lobes > 0) {
            lit_.push_back(hit);
            lobe_count = std::max(lobe_count, lobes);
        }
    }
    if (lit_.empty()) {
        return;
    }
    if (samples_.shadow_rays > 0 && find_obstacles(seed, hits)) {
        hits.obstructed[pixel] = 1;
        deviation_.assign(lit_.size(), Rgb(0));
        for (std::size_t lobe = 0; lobe < lobe_count; ++lobe) {
            shade_lobe(lobe, hits);
        }
        for (std::size_t i = 0; i < lit_.size(); ++i) {
            hits.noise[lit_[i]] += deviation_[i] * deviation_[i];
        }
        return;
    }
    for (const std::size_t hit : lit_) {
        for (std::size_t lobe = 0; lobe < materials_[hits.material[hit]].lobes().size(); ++lobe) {
            const DirectLightParts whole = unblocked(hits, hit, lobe);
            hits.radiance[hit] += whole.smooth + whole.spots;
        }
    }
}

/// Traces the pixel's rays; false: nothing is in their way.
bool ShadowedEnvironment::find_obstacles(std::uint32_t seed, const Hits& hits) {
    const RayPhase first = first_phase(samples_);
    rays_.trace(hits, lit_, first, seed);
    if (rays_.all_free()) {
        return false;
    }
    // Where all were blocked too: a window may be smaller than any light is.
    rays_.trace(hits, lit_, second_phase(samples_, first), seed);
    return true;
}

void ShadowedEnvironment::shade_lobe(std::size_t lobe, Hits& hits) {
    const auto material_of = [&](std::size_t i) -> std::size_t { return hits.material[lit_[i]]; };
    const auto has_lobe = [&](std::size_t i) { return lobe < materials_[material_of(i)].lobes().size(); };
    hit_sums_.assign(lit_.size(), {});
    material_sums_.clear();
    for (std::size_t i = 0; i < lit_.size(); ++i) {
        if (has_lobe(i)) {
            hit_sums_[i] =
                rays_.sum(hits, lit_, i, lobe, shading_->splits(material_of(i), lobe, hits.widths(lit_[i])[lobe]));
            const Vec3d weight(hits.weight(lit_[i], lobe));
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
    for (std::size_t i = 0; i < lit_.size(); ++i) {
        if (has_lobe(i)) {
            shade_hit(i, lobe, sums_of(material_of(i)), hits);
        }
    }
}

ShadowedEnvironment::MaterialSums& ShadowedEnvironment::sums_of(std::size_t material) {
    const auto known = std::find_if(material_sums_.begin(), material_sums_.end(),
                                    [&](const MaterialSums& sums) { return sums.material == material; });
    return known != material_sums_.end() ? *known : material_sums_.emplace_back(MaterialSums{material, {}, {}, {}});
}

void ShadowedEnvironment::shade_hit(std::size_t lit_index, std::size_t lobe, const MaterialSums& of_material,
                                    Hits& hits) {
    const std::size_t hit = lit_[lit_index];
    const DirectLightParts whole = unblocked(hits, hit, lobe);
    const EnvironmentRays::Sums& of_hit = hit_sums_[lit_index];
    if (is_mirror(lobe_of(hit, lobe, hits).shape)) {
        // One ray, that is all of its light.
        hits.radiance[hit] += whole.smooth * Rgb(quotient(of_hit.smooth.seen, of_hit.smooth.all));
        return;
    }
    hits.radiance[hit] += seen_part(whole.smooth, of_hit.smooth, of_material.kept_smooth);
    hits.radiance[hit] += seen_part(whole.spots, of_hit.spots, of_material.kept_spots);
    deviation_[lit_index] += deviation(whole.smooth, of_hit.smooth) + deviation(whole.spots, of_hit.spots);
}

Rgb ShadowedEnvironment::seen_part(const Rgb& unblocked, const RaySums& of_hit, const Vec3d& kept) const {
    const double rays = samples_.shadow_rays;
    return Rgb(of_hit.seen / rays + kept * (Vec3d(unblocked) - of_hit.all / rays));
}

}  // namespace shlight
