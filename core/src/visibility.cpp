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

ShadowedLight::ShadowedLight(const RayTracer& tracer, const RenderSettings& settings,
                             std::span<const OrderedMaterial> materials, std::size_t lobe_stride)
    : tracer_(&tracer),
      materials_(materials),
      lobe_stride_(lobe_stride),
      ray_count_(static_cast<std::uint32_t>(settings.shadow_rays)),
      pixel_samples_(static_cast<std::uint32_t>(settings.pixel_samples)) {
    const std::uint32_t least = (kLeastFirstPoints + pixel_samples_ - 1) / pixel_samples_;
    first_ray_count_ = std::min(ray_count_, std::max((ray_count_ + 3) / 4, least));
}

void ShadowedLight::add(const Light& light, std::span<const float> unshadowed,
                        std::span<const std::uint32_t> point_of_hit, std::span<const std::uint32_t> pixel_seeds,
                        Hits& hits) {
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
    const Phase first = {0, first_ray_count_, 0};
    const Phase second = {pixel_samples_ * first_ray_count_, ray_count_ - first_ray_count_,
                          lit_.size() * first_ray_count_};
    if (ray_count_ > 0) {
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
    shade(light, {}, hits);
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
        const std::uint32_t first_point = phase.first_point + hits.sample[hit] * phase.rays_per_hit;
        for (std::uint32_t ray = 0; ray < phase.rays_per_hit; ++ray) {
            const glm::dvec2 point = sobol(first_point + ray, seed);
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

float ShadowedLight::visible_share(const LobeShape& shape, const Vec3d& towards_viewer, std::size_t lit_index,
                                   std::span<const Phase> phases) const {
    double lobe_all = 0;
    double lobe_seen = 0;
    double all = 0;
    double seen = 0;
    for (const Phase& phase : phases) {
        for (std::size_t ray = 0; ray < phase.rays_per_hit; ++ray) {
            const std::size_t index = phase.offset + lit_index * phase.rays_per_hit + ray;
            const double weight = weights_[index];
            const double lobe_weight = weight * lobe_value(shape, Vec3d(directions_[index]), towards_viewer);
            all += weight;
            lobe_all += lobe_weight;
            if (blocked_[index] == 0) {
                seen += weight;
                lobe_seen += lobe_weight;
            }
        }
    }
    if (lobe_all > 0) {
        return static_cast<float>(lobe_seen / lobe_all);
    }
    return all > 0 ? static_cast<float>(seen / all) : 0.0F;
}

void ShadowedLight::shade(const Light& light, std::span<const Phase> phases, Hits& hits) const {
    for (std::size_t i = 0; i < lit_.size(); ++i) {
        const std::size_t hit = lit_[i];
        const float cosine = hits.cos_theta_o[hit];
        const Vec3d towards_viewer(std::sqrt(1.0 - static_cast<double>(cosine) * cosine), 0, cosine);
        const auto& lobes = materials_[hits.material[hit]].lobes();
        for (std::size_t lobe = 0; lobe < lobes.size(); ++lobe) {
            const float value = unshadowed(hit, lobe);
            if (!(value > 0)) continue;
            const LobeShape& shape = lobes[lobe].lobe().fit->shape();
            const float share = phases.empty() ? 1.0F : visible_share(shape, towards_viewer, i, phases);
            hits.radiance[hit] += lobes[lobe].lobe().scale(cosine) * radiance_of(light) * (value * share);
        }
    }
}

}  // namespace shlight
