// SPDX-License-Identifier: MIT
#include "visibility.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "ray_rounding.h"
#include "shlight/sampling.h"

namespace shlight {
namespace {

/// Points of the first phase that a pixel gets at least: fewer would miss too much of a penumbra's rim.
constexpr std::uint32_t kLeastFirstPoints = 16;

const Rgb& radiance_of(const Light& light) {
    return std::visit([](const auto& l) -> const Rgb& { return l.radiance; }, light);
}

/// Where on the light a shadow ray ends, relative to the point sampled: a polygon may lie in a mesh's face, its own or
/// one that it is mounted on, and must not be blocked by it. A float ray strays in proportion to its length too.
Vec3d clearance(const Light& light, const ShadingFrame& frame) {
    const auto* polygon = std::get_if<PolygonLight>(&light);
    if (polygon == nullptr) {
        return Vec3d(0);
    }
    const double distance = polygon->error + kRayRounding * glm::length(frame.origin - polygon->center);
    const bool front = glm::dot(polygon->normal, frame.origin - polygon->vertices[0]) > 0;
    return (front ? distance : -distance) * polygon->normal;
}

/// Shadow rays of one hit, in float but for the way from the rounded origin.
class RayStart {
  public:
    RayStart(const ShadingFrame& frame, const Vec3d& origin, const Vec3d& target_offset)
        : origin_(origin),
          x_(frame.x),
          y_(frame.y),
          z_(frame.z),
          offset_(frame.to_local(frame.origin - Vec3d(origin_) + target_offset)) {}

    /// To a point in the shading frame, all but the last few roundings.
    Ray towards(const Vec3d& local_target) const {
        const Vec3f way(local_target + offset_);
        return {origin_, 0.0F, way.x * x_ + way.y * y_ + way.z * z_, 1.0F - 0x1p-22F};
    }

  private:
    Vec3f origin_, x_, y_, z_;
    Vec3d offset_;
};

}  // namespace

ShadowedLight::ShadowedLight(const RayTracer& tracer, std::uint32_t most_rays, std::span<const MaterialLobes> materials,
                             std::size_t lobe_stride)
    : tracer_(&tracer), materials_(materials), lobe_stride_(lobe_stride), most_rays_(most_rays) {}

void ShadowedLight::add(const Light& light, const SampleRange& samples, std::span<const float> unshadowed,
                        std::span<const std::uint32_t> point_of_hit, std::span<const std::uint32_t> pixel_seeds,
                        Hits& hits) {
    samples_ = samples;
    const std::uint32_t least = (kLeastFirstPoints + samples.count - 1) / samples.count;
    first_ray_count_ = std::min(samples.shadow_rays, std::max((samples.shadow_rays + 3) / 4, least));
    unshadowed_ = unshadowed;
    point_of_hit_ = point_of_hit;
    for (std::size_t pixel = 0; pixel < hits.pixel_count(); ++pixel) {
        add_pixel(light, pixel_seeds[pixel], hits.pixel_begin[pixel], hits.pixel_begin[pixel + 1], hits);
    }
}

bool ShadowedLight::is_lit(const Light& light, const Hits& hits, std::size_t hit) const {
    bool any = false;
    for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
        any = any || unshadowed(hit, lobe) > 0;
    }
    // The hit itself may see less of the light than the point that it shares.
    return any && is_seen(light, hits.frame[hit], hits.error[hit]);
}

void ShadowedLight::add_pixel(const Light& light, std::uint32_t seed, std::size_t begin, std::size_t end, Hits& hits) {
    lit_.clear();
    for (std::size_t hit = begin; hit < end; ++hit) {
        if (is_lit(light, hits, hit)) {
            lit_.push_back(hit);
        }
    }
    if (lit_.empty()) {
        return;
    }
    // No two ranges of samples share a point.
    const std::uint32_t first_point = samples_.first * most_rays_;
    const Phase first = {first_point, first_ray_count_, 0};
    const Phase second = {first_point + samples_.count * first_ray_count_, samples_.shadow_rays - first_ray_count_,
                          lit_.size() * first_ray_count_};
    if (samples_.shadow_rays > 0) {
        trace(light, hits, first, seed);
        const auto blocked = std::count(blocked_.begin(), blocked_.end(), 1);
        if (blocked == static_cast<std::ptrdiff_t>(blocked_.size())) {
            return;
        }
        if (blocked > 0) {
            trace(light, hits, second, seed);
            shade(light, std::array{first, second}, hits);
            return;
        }
    }
    shade_unblocked(light, hits);
}

void ShadowedLight::trace(const Light& light, const Hits& hits, const Phase& phase, std::uint32_t seed) {
    const std::size_t count = phase.offset + lit_.size() * phase.rays_per_hit;
    directions_.resize(count);
    weights_.resize(count);
    blocked_.resize(count);
    rays_.resize(count - phase.offset);
    for (std::size_t i = 0; i < lit_.size(); ++i) {
        const std::size_t hit = lit_[i];
        const ShadingFrame& frame = hits.frame[hit];
        std::optional<CapSampler> cap_sampler;
        if (const auto* sphere = std::get_if<SphereLight>(&light)) {
            cap_sampler.emplace(*view(*sphere, frame));
        } else {
            polygon_sampler_.reset(std::get<PolygonLight>(light), frame);
        }
        const RayStart start(frame, hits.shadow_origin[hit], clearance(light, frame));
        const std::uint32_t first_point = phase.first_point + (hits.sample[hit] - samples_.first) * phase.rays_per_hit;
        for (std::uint32_t ray = 0; ray < phase.rays_per_hit; ++ray) {
            const glm::dvec2 point = sobol(shuffled(first_point + ray, seed), seed);
            const LightSample sample = cap_sampler ? cap_sampler->sample(point) : polygon_sampler_.sample(point);
            const std::size_t index = phase.offset + i * phase.rays_per_hit + ray;
            directions_[index] = Vec3f(sample.direction);
            weights_[index] = static_cast<float>(sample.weight);
            rays_[index - phase.offset] = start.towards(sample.distance * sample.direction);
        }
    }
    tracer_->occluded(rays_, std::span(blocked_).subspan(phase.offset));
    rays_traced_ += rays_.size();
}

ShadowedLight::RaySums ShadowedLight::sum(const LobeShape& shape, const Vec3d& towards_viewer, std::size_t lit_index,
                                          std::span<const Phase> phases) const {
    RaySums sums;
    for (const Phase& phase : phases) {
        for (std::size_t ray = 0; ray < phase.rays_per_hit; ++ray) {
            const std::size_t index = phase.offset + lit_index * phase.rays_per_hit + ray;
            const double weight = weights_[index];
            const double lobe_weight = weight * lobe_value(shape, Vec3d(directions_[index]), towards_viewer);
            sums.all += weight;
            sums.lobe_all += lobe_weight;
            if (blocked_[index] == 0) {
                sums.seen += weight;
                sums.lobe_seen += lobe_weight;
            }
        }
    }
    return sums;
}

Rgb ShadowedLight::scaled_radiance(const Light& light, const Hits& hits, std::size_t hit, std::size_t lobe) const {
    return materials_[hits.material[hit]].lobes()[lobe].scale(hits.cos_theta_o[hit]) * radiance_of(light) *
           unshadowed(hit, lobe);
}

void ShadowedLight::shade_unblocked(const Light& light, Hits& hits) const {
    for (const std::size_t hit : lit_) {
        for (std::size_t lobe = 0; lobe < materials_[hits.material[hit]].lobes().size(); ++lobe) {
            if (unshadowed(hit, lobe) > 0) {
                hits.radiance[hit] += scaled_radiance(light, hits, hit, lobe);
            }
        }
    }
}

void ShadowedLight::shade(const Light& light, std::span<const Phase> phases, Hits& hits) {
    deviation_.assign(lit_.size(), Rgb(0));
    for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
        shade_lobe(light, lobe, phases, hits);
    }
    for (std::size_t i = 0; i < lit_.size(); ++i) {
        hits.noise[lit_[i]] += deviation_[i] * deviation_[i];
    }
}

void ShadowedLight::shade_lobe(const Light& light, std::size_t lobe, std::span<const Phase> phases, Hits& hits) {
    const auto has_lobe = [&](std::size_t hit) {
        return lobe < materials_[hits.material[hit]].lobes().size() && unshadowed(hit, lobe) > 0;
    };
    const auto [first, last] = std::minmax_element(
        lit_.begin(), lit_.end(), [&](std::size_t a, std::size_t b) { return point_of_hit_[a] < point_of_hit_[b]; });
    const std::uint32_t first_point = point_of_hit_[*first];
    hit_sums_.assign(lit_.size(), {});
    point_sums_.assign(point_of_hit_[*last] - first_point + 1, {});
    for (std::size_t i = 0; i < lit_.size(); ++i) {
        const std::size_t hit = lit_[i];
        if (!has_lobe(hit)) continue;
        const double cosine = hits.cos_theta_o[hit];
        const Vec3d towards_viewer(std::sqrt(1.0 - cosine * cosine), 0, cosine);
        const LobeShape& shape = materials_[hits.material[hit]].lobes()[lobe].shape;
        hit_sums_[i] = sum(shape, towards_viewer, i, phases);
        RaySums& of_point = point_sums_[point_of_hit_[hit] - first_point];
        of_point.all += hit_sums_[i].all;
        of_point.lobe_all += hit_sums_[i].lobe_all;
        ++of_point.hits;
    }
    for (std::size_t i = 0; i < lit_.size(); ++i) {
        const std::size_t hit = lit_[i];
        if (!has_lobe(hit)) continue;
        const RaySums& of_point = point_sums_[point_of_hit_[hit] - first_point];
        const double count = of_point.hits;
        const double share = of_point.lobe_all > 0 ? count * hit_sums_[i].lobe_seen / of_point.lobe_all
                             : of_point.all > 0    ? count * hit_sums_[i].seen / of_point.all
                                                   : 0.0;
        const Rgb unblocked = scaled_radiance(light, hits, hit, lobe);
        hits.radiance[hit] += unblocked * static_cast<float>(share);
        // The lobes of a hit share its rays.
        const double own_share = hit_sums_[i].all > 0 ? hit_sums_[i].seen / hit_sums_[i].all : 0;
        deviation_[i] += unblocked * static_cast<float>(std::sqrt(own_share * (1 - own_share) / samples_.shadow_rays));
    }
}

}  // namespace shlight
