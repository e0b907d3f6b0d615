// SPDX-License-Identifier: MIT
#include "lighting/shadowed_light.h"

#include <algorithm>

#include "shlight/sampling.h"

namespace shlight {
namespace {

/// How much of what is known of the light without obstacles is put in the place of what the rays make of it: the
/// regression of what they see on it. Never so much that a sum could be negative.
Vec3d kept_share(const RaySums& sums, const Vec3d& otherwise) {
    const Vec3d share = glm::min(quotient(sums.seen_squares, sums.squares), quotient(sums.seen, sums.all));
    return glm::mix(otherwise, share, Vec3d(glm::greaterThan(sums.all, Vec3d(0))));
}

/// What is seen of the light without obstacles, by the mean over a hit's rays, as many as these of each set. The sums
/// are of absolute values.
Rgb seen_part(const Rgb& unblocked, const RaySums& of_hit, const Vec3d& kept, double rays) {
    const Vec3d magnitude(glm::abs(unblocked));
    return glm::sign(unblocked) * Rgb(of_hit.seen / rays + kept * (magnitude - of_hit.all / rays));
}

}  // namespace

void ShadowedLight::find_lit(std::size_t group, const Hits& hits) {
    const std::size_t begin = lit_.hit.size();
    for (std::size_t hit = hits.pixel_begin[group]; hit < hits.pixel_begin[group + 1]; ++hit) {
        const std::size_t first = lit_.shines.size();
        bool any = false;
        for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
            const bool shines = unblocked(light_, hits, hit, lobe) != Rgb(0);
            lit_.shines.push_back(shines ? 1 : 0);
            any = any || shines;
        }
        if (any && target_->add(hits, hit)) {
            lit_.hit.push_back(hit);
        } else {
            lit_.shines.resize(first);
        }
    }
    const LitRange range = {begin, lit_.hit.size()};
    if (range.size() > 0) {
        const std::uint32_t seed = hash(seeds_[group], static_cast<std::uint32_t>(index_));
        groups_.push_back({range, group, budget_->samples_of(index_, group, samples_), seed});
    }
}

void ShadowedLight::shade_lit(Hits& hits) {
    occluded_.clear();
    ranges_.clear();
    const auto dims = [&](std::size_t hit) { return hits.terminator[hit].dims(); };
    const bool shadows = samples_.shadow_rays > 0 && (light_.casts_shadows || std::ranges::any_of(lit_.hit, dims));
    if (shadows) {
        rays_.start(*target_, hits, lit_);
        for (const LitGroup& group : groups_) {
            rays_.draw(group.range, group.samples, group.seed);
        }
        rays_.trace(light_.casts_shadows);
    }
    for (const LitGroup& group : groups_) {
        const LightBits seen = shadows ? rays_.visibility(group.range, index_) : LightBits{};
        hits.visibility[group.group] |= seen;
        if (seen.hidden != 0 || (shadows && rays_.is_guided(group.range))) {
            occluded_.push_back(group);
            ranges_.push_back(group.range);
        } else {
            shade_unblocked(group.range, hits);
        }
    }
    if (!occluded_.empty()) {
        rays_.weigh(ranges_);
    }
    for (const LitGroup& group : occluded_) {
        shade(group, hits);
    }
    groups_.clear();
    lit_.clear();
    target_->clear();
}

void ShadowedLight::shade_unblocked(const LitRange& range, Hits& hits) const {
    for (std::size_t i = range.begin; i < range.end; ++i) {
        for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
            if (shines(i, lobe)) {
                hits.reflect(lit_.hit[i], lobe, light_.group, unblocked(light_, hits, lit_.hit[i], lobe));
            }
        }
    }
}

void ShadowedLight::shade(const LitGroup& group, Hits& hits) {
    deviation_.assign(group.range.size(), Rgb(0));
    for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
        shade_lobe(group, lobe, hits);
    }
    for (std::size_t i = 0; i < group.range.size(); ++i) {
        hits.noise[lit_.hit[group.range.begin + i]] += deviation_[i] * deviation_[i];
    }
}

void ShadowedLight::shade_lobe(const LitGroup& group, std::size_t lobe, Hits& hits) {
    const std::size_t begin = group.range.begin;
    hit_sums_.assign(group.range.size(), {});
    material_sums_.clear();
    for (std::size_t i = 0; i < group.range.size(); ++i) {
        if (!shines(begin + i, lobe)) continue;
        const std::size_t hit = lit_.hit[begin + i];
        hit_sums_[i] = rays_.sum(begin + i, lobe, light_.splits(hits.material[hit], lobe, hits.forms(hit)[lobe]));
        const Vec3d weight(glm::abs(hits.weight(hit, lobe)));
        hit_sums_[i].smooth *= weight;
        hit_sums_[i].spots *= weight;
        ShadowRays::Sums& sums = sums_of(hits.material[hit], hit_sums_[i].guided).sums;
        sums.smooth += hit_sums_[i].smooth;
        sums.spots += hit_sums_[i].spots;
    }
    for (MaterialSums& material : material_sums_) {
        if (material.sums.guided) continue;
        material.kept_smooth = kept_share(material.sums.smooth, Vec3d(1));
        // Spots that no ray has met are taken to be as hidden as the rest.
        material.kept_spots = kept_share(material.sums.spots, material.kept_smooth);
    }
    for (std::size_t i = 0; i < group.range.size(); ++i) {
        if (!shines(begin + i, lobe)) continue;
        const std::size_t hit = lit_.hit[begin + i];
        // The lobes of a hit share its rays.
        deviation_[i] += shade_hit(hit, lobe, hit_sums_[i], sums_of(hits.material[hit], hit_sums_[i].guided),
                                   group.samples.shadow_rays, hits);
    }
}

ShadowedLight::MaterialSums& ShadowedLight::sums_of(std::uint32_t material, bool guided) {
    const auto known = std::find_if(material_sums_.begin(), material_sums_.end(), [&](const MaterialSums& own) {
        return own.material == material && own.sums.guided == guided;
    });
    const MaterialSums none = {material, {{}, {}, 0, guided}, Vec3d(0), Vec3d(0)};
    return known != material_sums_.end() ? *known : material_sums_.emplace_back(none);
}

Rgb ShadowedLight::shade_hit(std::size_t hit, std::size_t lobe, const ShadowRays::Sums& of_hit,
                             const MaterialSums& of_material, double rays, Hits& hits) const {
    const auto part = [&](const Rgb& whole, const RaySums& own, const RaySums& all, const Vec3d& kept, Rgb& off) {
        off += of_hit.guided ? deviation(own, static_cast<double>(of_hit.rays)) / static_cast<float>(rays)
                             : deviation(glm::abs(whole), quotient(all.seen, all.all), own);
        return seen_part(whole, own, kept, rays);
    };
    Rgb off(0);
    Rgb seen = part(unblocked(light_.smooth, hits, hit, lobe), of_hit.smooth, of_material.sums.smooth,
                    of_material.kept_smooth, off);
    if (light_.environment != nullptr) {
        seen += part(unblocked(light_.spots, hits, hit, lobe), of_hit.spots, of_material.sums.spots,
                     of_material.kept_spots, off);
    }
    hits.reflect(hit, lobe, light_.group, seen);
    return off;
}

}  // namespace shlight
