// SPDX-License-Identifier: MIT
#include "shadowed_deltas.h"

#include <algorithm>
#include <limits>

#include "minor_lights.h"
#include "shlight/sampling.h"

namespace shlight {
namespace {

/// Values of a pixel that are held at a time, as many as fit the cache.
constexpr std::size_t kValues = std::size_t{1} << 17;

constexpr std::uint32_t kAbove = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint32_t kBelow = kAbove - 1;

std::size_t range_size(std::size_t values_per_light, std::size_t lights) {
    const std::size_t size = kValues / std::max<std::size_t>(values_per_light, 1) / kDeltaLanes * kDeltaLanes;
    return std::clamp(size, kDeltaLanes, lights);
}

}  // namespace

ShadowedDeltas::ShadowedDeltas(const RayTracer& tracer, std::span<const MaterialLobes> materials,
                               std::size_t lobe_stride, const DeltaLights& lights)
    : tracer_(&tracer), materials_(materials), lobe_stride_(lobe_stride), lights_(&lights) {}

void ShadowedDeltas::add(const ShadingPoints& points, bool shadows, std::span<const std::uint32_t> pixel_seeds,
                         Hits& hits, std::span<float> brightness, RenderReport& report) {
    shadows_ = shadows;
    for (std::size_t pixel = 0; pixel < hits.pixel_count(); ++pixel) {
        const std::size_t first = hits.pixel_begin[pixel];
        const std::size_t last = hits.pixel_begin[pixel + 1];
        brightness[pixel] = 0;
        if (first == last || lights_->padded_size() == 0) continue;
        // Points are numbered in the order of their first hits.
        const std::uint32_t last_point = *std::max_element(&points.of_hit[first], &points.of_hit[last - 1] + 1);
        const PixelRange range = {first, last, points.of_hit[first], last_point + 1U, pixel_seeds[pixel]};
        brightness[pixel] = add_pixel(points, range, hits, report);
    }
}

float ShadowedDeltas::add_pixel(const ShadingPoints& points, const PixelRange& pixel, Hits& hits,
                                RenderReport& report) {
    sort_hits(points, pixel);
    const std::size_t count = lights_->padded_size();
    const std::size_t step = range_size((pixel.last_point - pixel.first_point) * lobe_stride_, count);
    const auto range_from = [&](std::size_t begin) { return DeltaRange{begin, std::min(step, count - begin)}; };
    float all = 0;
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
        ask(points, pixel, range, all, hits);
        trace();
        find_shares(points, pixel, range, hits);
        add_shares(points, pixel, range, hits);
    }
    return all;
}

void ShadowedDeltas::sort_hits(const ShadingPoints& points, const PixelRange& pixel) {
    first_of_point_.assign(1, 0);
    for (std::size_t point = pixel.first_point; point < pixel.last_point; ++point) {
        first_of_point_.push_back(first_of_point_.back() + points.hit_count(point));
    }
    hits_by_point_.resize(pixel.last_hit - pixel.first_hit);
    for (std::size_t hit = pixel.first_hit; hit < pixel.last_hit; ++hit) {
        hits_by_point_[first_of_point_[points.of_hit[hit] - pixel.first_point]++] = hit;
    }
    // Each has come to where the next one began.
    first_of_point_.insert(first_of_point_.begin(), 0);
    first_of_point_.pop_back();
}

void ShadowedDeltas::find_values(const ShadingPoints& points, const PixelRange& pixel, const DeltaRange& range) {
    const std::size_t point_count = pixel.last_point - pixel.first_point;
    values_.resize(point_count * lobe_stride_ * range.count);
    point_brightness_.assign(point_count * range.count, 0.0F);
    brightness_.assign(range.count, 0.0F);
    for (std::size_t p = 0; p < point_count; ++p) {
        const std::size_t point = pixel.first_point + p;
        const float cosine = points.cos_theta_o[point];
        const std::span<const Lobe> lobes = materials_[points.material[point]].lobes();
        float* own = &point_brightness_[p * range.count];
        lights_->see(range, points.frame[point], points.error[point], views_);
        for (std::size_t lobe = 0; lobe < lobes.size(); ++lobe) {
            float* of_lobe = values(p, lobe, range);
            lights_->reflect(range, views_, lobes[lobe].shape, cosine, of_lobe);
            const Rgb weight = static_cast<float>(points.hit_count(point)) * glm::abs(lobes[lobe].scale(cosine));
            add_weighted(of_lobe, lights_->magnitudes(range.begin), weight, range.count, own);
        }
        for (std::size_t i = 0; i < range.count; ++i) {
            brightness_[i] += own[i];
        }
    }
}

void ShadowedDeltas::ask(const ShadingPoints& points, const PixelRange& pixel, const DeltaRange& range, float all,
                         const Hits& hits) {
    const std::size_t hit_count = hits_by_point_.size();
    asked_.clear();
    questions_.clear();
    rays_.clear();
    for (std::size_t light = 0; light < range.count; ++light) {
        if (!(brightness_[light] > 0)) continue;
        const std::size_t rays = hits_to_ask(brightness_[light], all, hit_count);
        if (rays == hit_count) {
            ask_each(range, light, hits);
        } else {
            ask_some(points, pixel, range, light, rays, hits);
        }
        asked_.push_back({light, questions_.size(), rays == hit_count});
    }
}

void ShadowedDeltas::ask_each(const DeltaRange& range, std::size_t light, const Hits& hits) {
    for (std::size_t p = 0; p + 1 < first_of_point_.size(); ++p) {
        for (std::size_t k = first_of_point_[p];
             k < first_of_point_[p + 1] && point_brightness_[p * range.count + light] > 0; ++k) {
            question(range, light, hits_by_point_[k], hits);
        }
    }
}

void ShadowedDeltas::ask_some(const ShadingPoints& points, const PixelRange& pixel, const DeltaRange& range,
                              std::size_t light, std::size_t rays, const Hits& hits) {
    // Evenly spaced steps of brightness, from a random start that is less than a step: so there is one at least.
    const float step = brightness_[light] / static_cast<float>(rays);
    const std::uint32_t random = hash(pixel.seed, static_cast<std::uint32_t>(range.begin + light)) >> 9U;
    float next = step * (static_cast<float>(random) * 0x1p-23F);
    float before = 0;
    for (std::size_t p = 0; next < brightness_[light] && p + 1 < first_of_point_.size(); ++p) {
        const float own = point_brightness_[p * range.count + light];
        const std::size_t count = points.hit_count(pixel.first_point + p);
        while (next < before + own) {
            const auto k = static_cast<std::size_t>((next - before) / own * static_cast<float>(count));
            question(range, light, hits_by_point_[first_of_point_[p] + std::min(k, count - 1)], hits);
            next += step;
        }
        before += own;
    }
}

void ShadowedDeltas::question(const DeltaRange& range, std::size_t light, std::size_t hit, const Hits& hits) {
    const std::size_t i = range.begin + light;
    // The hit itself may see less of the source than the point that it shares.
    if (!lights_->shines(i, hits.frame[hit], hits.error[hit])) {
        questions_.push_back({hit, kBelow});
    } else if (!shadows_ || !lights_->casts_shadows(i)) {
        questions_.push_back({hit, kAbove});
    } else {
        questions_.push_back({hit, static_cast<std::uint32_t>(rays_.size())});
        rays_.push_back(lights_->ray(i, hits.shadow_origin[hit]));
    }
}

void ShadowedDeltas::trace() {
    blocked_.resize(rays_.size());
    tracer_->occluded(rays_, blocked_);
    rays_traced_ += rays_.size();
}

void ShadowedDeltas::find_shares(const ShadingPoints& points, const PixelRange& pixel, const DeltaRange& range,
                                 Hits& hits) {
    for (std::vector<float>* array : {&seen_r_, &seen_g_, &seen_b_}) {
        array->assign(range.count, 0.0F);
    }
    const auto is_seen = [&](const Question& q) {
        return q.ray == kAbove || (q.ray != kBelow && blocked_[q.ray] == 0);
    };
    std::size_t begin = 0;
    for (const Asked& asked : asked_) {
        const std::span<const Question> questions(&questions_[begin], asked.end - begin);
        begin = asked.end;
        const Rgb strength = lights_->strength(range.begin + asked.light);
        const auto seen = static_cast<std::size_t>(std::count_if(questions.begin(), questions.end(), is_seen));
        if (!asked.each_hit || seen == questions.size()) {
            const Rgb part = strength * (static_cast<float>(seen) / static_cast<float>(questions.size()));
            seen_r_[asked.light] = part.x;
            seen_g_[asked.light] = part.y;
            seen_b_[asked.light] = part.z;
            continue;
        }
        for (const Question& q : questions) {
            const auto lobes = materials_[hits.material[q.hit]].lobes();
            for (std::size_t lobe = 0; lobe < lobes.size() && is_seen(q); ++lobe) {
                const float value = values(points.of_hit[q.hit] - pixel.first_point, lobe, range)[asked.light];
                hits.radiance[q.hit] += lobes[lobe].scale(hits.cos_theta_o[q.hit]) * strength * value;
            }
        }
    }
}

void ShadowedDeltas::add_shares(const ShadingPoints& points, const PixelRange& pixel, const DeltaRange& range,
                                Hits& hits) {
    const ColorArrays seen = {seen_r_.data(), seen_g_.data(), seen_b_.data()};
    for (std::size_t p = 0; p + 1 < first_of_point_.size(); ++p) {
        const auto lobes = materials_[points.material[pixel.first_point + p]].lobes();
        for (std::size_t lobe = 0; lobe < lobes.size(); ++lobe) {
            const Rgb sum = weighted_sum(values(p, lobe, range), seen, range.count);
            for (std::size_t k = first_of_point_[p]; k < first_of_point_[p + 1]; ++k) {
                const std::size_t hit = hits_by_point_[k];
                hits.radiance[hit] += lobes[lobe].scale(hits.cos_theta_o[hit]) * sum;
            }
        }
    }
}

std::uint64_t ShadowedDeltas::count_values(const ShadingPoints& points, const PixelRange& pixel,
                                           const DeltaRange& range) const {
    std::uint64_t sum = 0;
    for (std::size_t p = 0; p + 1 < first_of_point_.size(); ++p) {
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
