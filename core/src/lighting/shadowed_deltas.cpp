// SPDX-License-Identifier: MIT
#include "lighting/shadowed_deltas.h"

#include <algorithm>
#include <limits>

#include "base/even_steps.h"
#include "lighting/shadow_policy.h"
#include "shlight/sampling.h"

namespace shlight {
namespace {

/// Values of a pixel that are held at a time, as many as fit the cache.
constexpr std::size_t kDeltaValues = std::size_t{1} << 17;

constexpr std::uint32_t kAbove = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint32_t kBelow = kAbove - 1;

std::size_t range_size(std::size_t values_per_light, std::size_t lights) {
    const std::size_t size = kDeltaValues / std::max<std::size_t>(values_per_light, 1) / kDeltaLanes * kDeltaLanes;
    return std::clamp(size, kDeltaLanes, lights);
}

}  // namespace

ShadowedDeltas::ShadowedDeltas(ShadowTracer& tracer, std::span<const MaterialLobes> materials, std::size_t lobe_stride)
    : tracer_(&tracer), materials_(materials), lobe_stride_(lobe_stride) {}

void ShadowedDeltas::add(const DeltaLights& lights, const ShadingPoints& points, bool shadows,
                         std::span<const std::uint32_t> pixel_seeds, Hits& hits, std::span<float> brightness,
                         RenderReport& report) {
    lights_ = &lights;
    shadows_ = shadows;
    for (std::size_t pixel = 0; pixel < hits.pixel_count(); ++pixel) {
        const std::size_t hit_count = hits.pixel_begin[pixel + 1] - hits.pixel_begin[pixel];
        if (hit_count == 0 || lights_->padded_size() == 0) continue;
        const PixelRange range = {hit_count, points.pixel_begin[pixel], points.pixel_begin[pixel + 1],
                                  pixel_seeds[pixel]};
        brightness[pixel] = add_pixel(points, range, brightness[pixel], hits, report);
    }
}

float ShadowedDeltas::add_pixel(const ShadingPoints& points, const PixelRange& pixel, float others, Hits& hits,
                                RenderReport& report) {
    const std::size_t count = lights_->padded_size();
    const std::size_t step = range_size(pixel.point_count() * lobe_stride_, count);
    const auto range_from = [&](std::size_t begin) { return DeltaRange{begin, std::min(step, count - begin)}; };
    float all = others;
    for (std::size_t begin = 0; begin < count; begin += step) {
        find_values(points, pixel, range_from(begin));
        for (const float own : brightness_) {
            all += own;
        }
    }
    for (std::size_t begin = 0; begin < count; begin += step) {
        const DeltaRange range = range_from(begin);
        if (step < count) {
            find_values(points, pixel, range);
        }
        report.cubature_count += count_values(points, pixel, range);
        request(points, pixel, range, all, hits);
        trace();
        find_shares(points, pixel, range, hits);
        add_shares(points, pixel, range, hits);
    }
    return all;
}

void ShadowedDeltas::find_values(const ShadingPoints& points, const PixelRange& pixel, const DeltaRange& range) {
    const std::size_t point_count = pixel.point_count();
    values_.resize(point_count * lobe_stride_ * range.count);
    point_brightness_.assign(point_count * range.count, 0.0F);
    brightness_.assign(range.count, 0.0F);
    for (std::size_t p = 0; p < point_count; ++p) {
        const std::size_t point = pixel.first_point + p;
        const float cosine = points.cos_theta_o[point];
        const std::span<const Lobe> lobes = materials_[points.material[point]].lobes();
        float* own = point_brightness_.data() + p * range.count;
        lights_->see(range, points.frame[point], points.error[point], views_);
        for (std::size_t lobe = 0; lobe < lobes.size(); ++lobe) {
            float* of_lobe = values(p, lobe, range);
            const LobeShape shape = materials_[points.material[point]].shape(lobe, points.forms(point)[lobe]);
            lights_->reflect(range, views_, shape, cosine, of_lobe);
            for (std::size_t i = 0; lights_->are_linked() && i < range.count; ++i) {
                const bool lit = lights_->lights(range.begin + i, materials_[points.material[point]].light_set());
                of_lobe[i] = lit ? of_lobe[i] : 0.0F;
            }
            const Rgb weight = static_cast<float>(points.hit_count(point)) * glm::abs(points.weight(point, lobe));
            add_weighted(of_lobe, lights_->magnitudes(range.begin), weight, range.count, own);
        }
        for (std::size_t i = 0; i < range.count; ++i) {
            brightness_[i] += own[i];
        }
    }
}

void ShadowedDeltas::request(const ShadingPoints& points, const PixelRange& pixel, const DeltaRange& range, float all,
                             const Hits& hits) {
    sampled_.clear();
    samples_.clear();
    rays_.clear();
    for (std::size_t light = 0; light < range.count; ++light) {
        if (!(brightness_[light] > 0)) continue;
        const std::size_t rays = hits_to_sample(brightness_[light], all, pixel.hit_count);
        if (rays == pixel.hit_count) {
            request_all(points, pixel, range, light, hits);
        } else {
            request_some(points, pixel, range, light, rays, hits);
        }
        sampled_.push_back({light, samples_.size(), rays == pixel.hit_count});
    }
}

void ShadowedDeltas::request_all(const ShadingPoints& points, const PixelRange& pixel, const DeltaRange& range,
                                 std::size_t light, const Hits& hits) {
    for (std::size_t p = 0; p < pixel.point_count(); ++p) {
        if (point_brightness_[p * range.count + light] > 0) {
            for (const std::size_t hit : points.hits_of(pixel.first_point + p)) {
                add_sample(range, light, hit, hits);
            }
        }
    }
}

void ShadowedDeltas::request_some(const ShadingPoints& points, const PixelRange& pixel, const DeltaRange& range,
                                  std::size_t light, std::size_t rays, const Hits& hits) {
    EvenSteps steps(brightness_[light], rays, hash(pixel.seed, static_cast<std::uint32_t>(range.begin + light)));
    for (std::size_t p = 0; p < pixel.point_count(); ++p) {
        const std::span<const std::size_t> own_hits = points.hits_of(pixel.first_point + p);
        steps.within(point_brightness_[p * range.count + light], own_hits.size(),
                     [&](std::size_t k) { add_sample(range, light, own_hits[k], hits); });
    }
}

void ShadowedDeltas::add_sample(const DeltaRange& range, std::size_t light, std::size_t hit, const Hits& hits) {
    const std::size_t i = range.begin + light;
    // The hit itself may see less of the source than the point that it shares.
    if (!lights_->shines(i, hits.frame[hit], hits.error[hit])) {
        samples_.push_back({hit, kBelow});
    } else if (!shadows_ || !lights_->casts_shadows(i)) {
        samples_.push_back({hit, kAbove});
    } else {
        samples_.push_back({hit, static_cast<std::uint32_t>(rays_.size())});
        rays_.push_back(lights_->ray(i, hits.shadow_start(hit, lights_->way(i, hits.frame[hit].origin))));
    }
}

void ShadowedDeltas::trace() {
    visible_.resize(rays_.size());
    tracer_->visibility(rays_, visible_);
}

void ShadowedDeltas::find_shares(const ShadingPoints& points, const PixelRange& pixel, const DeltaRange& range,
                                 Hits& hits) {
    for (std::vector<float>* array : {&seen_r_, &seen_g_, &seen_b_}) {
        array->assign(range.count, 0.0F);
    }
    std::size_t begin = 0;
    for (const SampledSource& sampled : sampled_) {
        const std::span<const ShadowSample> samples(samples_.data() + begin, sampled.end - begin);
        begin = sampled.end;
        const std::size_t light = range.begin + sampled.light;
        const Rgb strength = lights_->strength(light);
        const auto visible = [&](const ShadowSample& q) {
            const Rgb reaches = q.ray == kAbove ? Rgb(1) : q.ray == kBelow ? Rgb(0) : visible_[q.ray];
            return reaches * static_cast<float>(hits.let_in(q.hit, lights_->way(light, hits.frame[q.hit].origin)));
        };
        Rgb seen(0);
        for (const ShadowSample& q : samples) {
            seen += visible(q);
        }
        const auto count = static_cast<float>(samples.size());
        if (!sampled.each_hit || seen == Rgb(count)) {
            const Rgb part = strength * (seen / count);
            seen_r_[sampled.light] = part.x;
            seen_g_[sampled.light] = part.y;
            seen_b_[sampled.light] = part.z;
            continue;
        }
        for (const ShadowSample& q : samples) {
            const auto lobes = materials_[hits.material[q.hit]].lobes();
            const Rgb share = visible(q);
            for (std::size_t lobe = 0; lobe < lobes.size() && share != Rgb(0); ++lobe) {
                const float value = values(points.of_hit[q.hit] - pixel.first_point, lobe, range)[sampled.light];
                hits.reflect(q.hit, lobe, lights_->group(light), hits.weight(q.hit, lobe) * strength * share * value);
            }
        }
    }
}

void ShadowedDeltas::add_shares(const ShadingPoints& points, const PixelRange& pixel, const DeltaRange& range,
                                Hits& hits) {
    const ColorArrays seen = {seen_r_.data(), seen_g_.data(), seen_b_.data()};
    for (std::size_t p = 0; p < pixel.point_count(); ++p) {
        const auto lobes = materials_[points.material[pixel.first_point + p]].lobes();
        for (std::size_t lobe = 0; lobe < lobes.size(); ++lobe) {
            const Rgb sum = weighted_sum(values(p, lobe, range), seen, range.count);
            for (const std::size_t hit : points.hits_of(pixel.first_point + p)) {
                hits.radiance[hit] += hits.weight(hit, lobe) * sum;
            }
            if (!hits.apart.empty()) {
                keep_apart(values(p, lobe, range), range, points.hits_of(pixel.first_point + p), lobe, hits);
            }
        }
    }
}

void ShadowedDeltas::keep_apart(const float* values, const DeltaRange& range, std::span<const std::size_t> own_hits,
                                std::size_t lobe, Hits& hits) const {
    Rgb weight(0);
    for (std::size_t i = 0; i < own_hits.size(); ++i) {
        const std::size_t hit = own_hits[i];
        weight += hits.weight(hit, lobe);
        if (i + 1 == own_hits.size() || hits.in_apart[own_hits[i + 1]] != hits.in_apart[hit]) {
            add_parts(values, range, weight, hits.apart.parts().kind(hits.material[hit], lobe, hits.path[hit]),
                      hits.apart.of(hits.in_apart[hit]));
            weight = Rgb(0);
        }
    }
}

void ShadowedDeltas::add_parts(const float* values, const DeltaRange& range, const Rgb& weight, LightKind kind,
                               std::span<Rgb> apart) const {
    Rgb sum(0);
    for (std::size_t i = 0; i < range.count; ++i) {
        const Rgb light = weight * values[i] * Rgb(seen_r_[i], seen_g_[i], seen_b_[i]);
        apart[LightParts::of_group(lights_->group(range.begin + i))] += light;
        sum += light;
    }
    apart[LightParts::of_kind(kind)] += sum;
}

std::uint64_t ShadowedDeltas::count_values(const ShadingPoints& points, const PixelRange& pixel,
                                           const DeltaRange& range) const {
    std::uint64_t sum = 0;
    for (std::size_t p = 0; p < pixel.point_count(); ++p) {
        const std::size_t lobe_count = materials_[points.material[pixel.first_point + p]].lobes().size();
        for (std::size_t lobe = 0; lobe < lobe_count; ++lobe) {
            const float* of_lobe = values(p, lobe, range);
            std::uint32_t positive = 0;
            for (std::size_t i = 0; i < range.count; ++i) {
                positive += of_lobe[i] > 0 ? 1U : 0U;
            }
            sum += std::uint64_t{positive} * points.hit_count(pixel.first_point + p);
        }
    }
    return sum;
}

}  // namespace shlight
