// SPDX-License-Identifier: MIT
#include "shadows/dim_lights.h"

#include <algorithm>
#include <cmath>

#include "base/even_steps.h"
#include "shlight/sampling.h"

namespace shlight {
namespace {

/// Beside the seed of a pixel and light.
constexpr std::uint32_t kStartSeed = 0xFFFFFFFFU;

/// Rays of a hit where one ray each has met nothing that a lobe reflects: of a light that the horizon cuts, or that a
/// narrow lobe reflects a part of.
constexpr std::uint32_t kMoreRays = 16;

}  // namespace

void DimLights::start(const ShadingPoints& points) {
    points_ = &points;
    radiance_.assign(points.size(), Rgb(0));
}

void DimLights::finish(Hits& hits) const {
    for (std::size_t hit = 0; hit < hits.size(); ++hit) {
        hits.radiance[hit] += radiance_[points_->of_hit[hit]];
    }
}

void DimLights::add(const Light& light, const LightRadiance& unshadowed, std::size_t pixel, float brightness,
                    const RayPhase& phase, std::size_t questions, std::uint32_t seed, const Hits& hits,
                    ShadowRays& rays) {
    const std::size_t begin = points_->pixel_begin[pixel];
    const std::size_t end = points_->pixel_begin[pixel + 1];
    for (std::size_t first = begin; first < end; ++first) {
        const auto material = points_->material.begin();
        const auto here = material + static_cast<std::ptrdiff_t>(first);
        if (std::find(material + static_cast<std::ptrdiff_t>(begin), here, *here) != here) {
            continue;
        }
        const float own = gather(unshadowed, first, end);
        if (own > 0) {
            const float part = std::max(std::ceil(own / brightness * static_cast<float>(questions)), 1.0F);
            draw(light, unshadowed, own, static_cast<std::size_t>(part), seed, hits);
            for (const std::uint32_t count : {1U, kMoreRays}) {
                rays.trace(light, hits, asked_, {true, phase.first_point, phase.first_sample, count}, seed);
                if (find_shares(hits, rays)) {
                    break;
                }
            }
            shade(unshadowed);
        }
    }
}

float DimLights::gather(const LightRadiance& unshadowed, std::size_t first, std::size_t last) {
    members_.clear();
    float sum = 0;
    for (std::size_t point = first; point < last; ++point) {
        if (points_->material[point] == points_->material[first]) {
            members_.push_back({point, brightness_->of_point(unshadowed, point)});
            sum += members_.back().brightness;
        }
    }
    return sum;
}

void DimLights::draw(const Light& light, const LightRadiance& unshadowed, float brightness, std::size_t questions,
                     std::uint32_t seed, const Hits& hits) {
    asked_.clear();
    density_.clear();
    EvenSteps steps(brightness, questions, hash(seed, kStartSeed));
    for (const Member& member : members_) {
        const std::span<const std::size_t> own_hits = points_->hits_of(member.point);
        steps.within(member.brightness, own_hits.size(), [&](std::size_t k) {
            const std::size_t hit = own_hits[k];
            if (!asked_.add(light, hits, hit)) {
                return;
            }
            density_.push_back(double{member.brightness} / static_cast<double>(own_hits.size()));
            for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
                asked_.shines.push_back(unshadowed.values[lobe * points_->size() + member.point] > 0 ? 1 : 0);
            }
        });
    }
}

bool DimLights::find_shares(const Hits& hits, const ShadowRays& rays) {
    shares_.assign(lobe_stride_, Rgb(0));
    bool complete = true;
    for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
        Vec3d seen(0);
        Vec3d all(0);
        bool any = false;
        for (std::size_t i = 0; i < asked_.hit.size(); ++i) {
            if (asked_.shines[i * lobe_stride_ + lobe] != 0) {
                const RaySums sums = rays.sum(hits, asked_, i, lobe);
                seen += sums.seen / density_[i];
                all += sums.all / density_[i];
                any = true;
            }
        }
        complete = complete && (all != Vec3d(0) || !any);
        shares_[lobe] = Rgb(quotient(seen, all));
    }
    return complete;
}

void DimLights::shade(const LightRadiance& unshadowed) {
    for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
        for (const Member& member : members_) {
            radiance_[member.point] +=
                shares_[lobe] * points_->weight(member.point, lobe) * unshadowed[lobe * points_->size() + member.point];
        }
    }
}

}  // namespace shlight
