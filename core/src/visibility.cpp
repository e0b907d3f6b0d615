// SPDX-License-Identifier: MIT
#include "visibility.h"

#include <algorithm>
#include <cmath>

#include "minor_lights.h"

namespace shlight {

ShadowedLight::ShadowedLight(const RayTracer& tracer, std::uint32_t most_rays, std::span<const MaterialLobes> materials,
                             std::size_t lobe_stride)
    : materials_(materials), lobe_stride_(lobe_stride), most_rays_(most_rays), rays_(tracer, materials, lobe_stride) {}

void ShadowedLight::add(const Light& light, const SampleRange& samples, std::span<const float> unshadowed,
                        std::span<const std::uint32_t> point_of_hit, std::span<const std::uint32_t> pixel_seeds,
                        Hits& hits) {
    samples_ = samples;
    first_ray_count_ = samples.first_shadow_rays();
    unshadowed_ = unshadowed;
    point_of_hit_ = point_of_hit;
    for (std::size_t pixel = 0; pixel < hits.pixel_count(); ++pixel) {
        pixel_brightness_ = &brightness_[pixel];
        add_pixel(light, pixel_seeds[pixel], hits.pixel_begin[pixel], hits.pixel_begin[pixel + 1], hits);
    }
}

void ShadowedLight::find_lit(const Light& light, const Hits& hits, std::size_t begin, std::size_t end) {
    lit_.hit.clear();
    lit_.shines.clear();
    for (std::size_t hit = begin; hit < end; ++hit) {
        bool any = false;
        for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
            any = any || unshadowed(hit, lobe) > 0;
        }
        // The hit itself may see less of the light than the point that it shares.
        if (any && is_seen(light, hits.frame[hit], hits.error[hit])) {
            lit_.hit.push_back(hit);
            for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
                lit_.shines.push_back(unshadowed(hit, lobe) > 0 ? 1 : 0);
            }
        }
    }
}

bool ShadowedLight::is_glossy(std::uint32_t material) const {
    const auto lobes = materials_[material].lobes();
    return std::any_of(lobes.begin(), lobes.end(),
                       [](const Lobe& lobe) { return std::holds_alternative<GgxShape>(lobe.shape); });
}

void ShadowedLight::add_pixel(const Light& light, std::uint32_t seed, std::size_t begin, std::size_t end, Hits& hits) {
    find_lit(light, hits, begin, end);
    if (lit_.hit.empty()) {
        return;
    }
    if (samples_.shadow_rays > 0 && traits_of(light).casts_shadows) {
        if (const std::size_t stride = stride_of(light, hits); stride > 1) {
            add_minor(light, stride, seed, hits);
            return;
        }
        // No two ranges of samples share a point.
        const std::uint32_t first_point = samples_.first * most_rays_;
        rays_.trace(light, hits, lit_, {true, first_point, samples_.first, first_ray_count_}, seed);
        const std::size_t blocked = rays_.blocked_count();
        // Few rays may miss the part of a light that is seen, and a glossy lobe may have its peak there.
        if (blocked > 0 && blocked == rays_.count() && !is_glossy(hits.material[lit_.hit[0]])) {
            return;
        }
        if (blocked > 0) {
            rays_.trace(light, hits, lit_,
                        {false, first_point + samples_.count * first_ray_count_, samples_.first,
                         samples_.shadow_rays - first_ray_count_},
                        seed);
            shade(light, hits);
            return;
        }
    }
    shade_unblocked(light, hits);
}

std::size_t ShadowedLight::stride_of(const Light& light, const Hits& hits) {
    const Rgb& strength = strength_of(light);
    float own = 0;
    bool alike = true;
    for (const std::size_t hit : lit_.hit) {
        const std::span<const Lobe> lobes = materials_[hits.material[hit]].lobes();
        alike = alike && hits.material[hit] == hits.material[lit_.hit[0]];
        for (std::size_t lobe = 0; lobe < lobes.size(); ++lobe) {
            const Rgb radiance = lobes[lobe].scale(hits.cos_theta_o[hit]) * strength * unshadowed(hit, lobe);
            own += std::abs(radiance.x) + std::abs(radiance.y) + std::abs(radiance.z);
        }
    }
    *pixel_brightness_ += own;
    return alike ? lit_.hit.size() / hits_to_ask(own, *pixel_brightness_, lit_.hit.size()) : 1;
}

void ShadowedLight::add_minor(const Light& light, std::size_t stride, std::uint32_t seed, Hits& hits) {
    std::swap(lit_, all_lit_);
    lit_.hit.clear();
    lit_.shines.clear();
    for (std::size_t i = seed % stride; i < all_lit_.hit.size(); i += stride) {
        lit_.hit.push_back(all_lit_.hit[i]);
        const auto* shines = &all_lit_.shines[i * lobe_stride_];
        lit_.shines.insert(lit_.shines.end(), shines, shines + lobe_stride_);
    }
    rays_.trace(light, hits, lit_, {true, samples_.first * most_rays_, samples_.first, first_ray_count_}, seed);
    for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
        double seen = 0;
        double all = 0;
        for (std::size_t i = 0; i < lit_.hit.size(); ++i) {
            if (shines(i, lobe)) {
                const RaySums sums = rays_.sum(hits, lit_, i, lobe);
                seen += sums.seen;
                all += sums.all;
            }
        }
        const double share = all > 0 ? seen / all : 1.0;
        for (std::size_t i = 0; i < all_lit_.hit.size(); ++i) {
            if (all_lit_.shines[i * lobe_stride_ + lobe] != 0) {
                hits.radiance[all_lit_.hit[i]] +=
                    scaled_radiance(light, hits, all_lit_.hit[i], lobe) * static_cast<float>(share);
            }
        }
    }
    std::swap(lit_, all_lit_);
}

Rgb ShadowedLight::scaled_radiance(const Light& light, const Hits& hits, std::size_t hit, std::size_t lobe) const {
    return materials_[hits.material[hit]].lobes()[lobe].scale(hits.cos_theta_o[hit]) * strength_of(light) *
           unshadowed(hit, lobe);
}

void ShadowedLight::shade_unblocked(const Light& light, Hits& hits) const {
    for (std::size_t i = 0; i < lit_.hit.size(); ++i) {
        for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
            if (shines(i, lobe)) {
                hits.radiance[lit_.hit[i]] += scaled_radiance(light, hits, lit_.hit[i], lobe);
            }
        }
    }
}

void ShadowedLight::shade(const Light& light, Hits& hits) {
    deviation_.assign(lit_.hit.size(), Rgb(0));
    for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
        shade_lobe(light, lobe, hits);
    }
    for (std::size_t i = 0; i < lit_.hit.size(); ++i) {
        hits.noise[lit_.hit[i]] += deviation_[i] * deviation_[i];
    }
}

void ShadowedLight::shade_lobe(const Light& light, std::size_t lobe, Hits& hits) {
    const auto [first, last] = std::minmax_element(lit_.hit.begin(), lit_.hit.end(), [&](std::size_t a, std::size_t b) {
        return point_of_hit_[a] < point_of_hit_[b];
    });
    const std::uint32_t first_point = point_of_hit_[*first];
    hit_sums_.assign(lit_.hit.size(), {});
    point_sums_.assign(point_of_hit_[*last] - first_point + 1, {});
    for (std::size_t i = 0; i < lit_.hit.size(); ++i) {
        if (!shines(i, lobe)) continue;
        hit_sums_[i] = rays_.sum(hits, lit_, i, lobe);
        PointSums& of_point = point_sums_[point_of_hit_[lit_.hit[i]] - first_point];
        of_point.all += hit_sums_[i].all;
        ++of_point.hits;
    }
    for (std::size_t i = 0; i < lit_.hit.size(); ++i) {
        if (!shines(i, lobe)) continue;
        const std::size_t hit = lit_.hit[i];
        const RaySums& sums = hit_sums_[i];
        const PointSums& of_point = point_sums_[point_of_hit_[hit] - first_point];
        const double share = of_point.all > 0 ? of_point.hits * sums.seen / of_point.all : 0.0;
        const Rgb unblocked = scaled_radiance(light, hits, hit, lobe);
        hits.radiance[hit] += unblocked * static_cast<float>(share);
        if (sums.all > 0) {
            // As of so many rays of equal weight; the lobes of a hit share its rays.
            const double own_share = sums.seen / sums.all;
            const double rays = sums.all * sums.all / sums.squares;
            deviation_[i] += unblocked * static_cast<float>(std::sqrt(own_share * (1 - own_share) / rays));
        }
    }
}

}  // namespace shlight
