// SPDX-License-Identifier: MIT
#include "shadows/environment_rays.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "environment/environment_map.h"
#include "shadows/ray_start.h"
#include "shlight/sampling.h"

namespace shlight {
/// Directions from one hit, and how densely all sets together draw them.
class EnvironmentRays::Directions {
  public:
    Directions(std::span<const LobeShape> lobes, const Vec3d& view, const EnvironmentMap* map,
               const ShadingFrame& frame)
        : lobes_(lobes), view_(view), map_(lobes.empty() ? nullptr : map) {
        if (map_ != nullptr) {
            to_map_ = glm::dmat3(map->to_map(frame.x), map->to_map(frame.y), map->to_map(frame.z));
        }
    }

    std::size_t set_count() const { return lobes_.size() + (map_ != nullptr ? 1 : 0); }
    /// May lie below the horizon.
    Vec3d sample(std::size_t set, const glm::dvec2& point) const {
        const bool of_map = map_ != nullptr && set == lobes_.size();
        return of_map ? map_->sampler.sample(point) * to_map_ : sample_lobe(lobes_[set], view_, point);
    }
    double density(const Vec3d& direction) const {
        double sum = map_ != nullptr ? map_->sampler.density(to_map_ * direction) : 0.0;
        for (const LobeShape& lobe : lobes_) {
            sum += lobe_density(lobe, view_, direction);
        }
        return sum;
    }

  private:
    std::span<const LobeShape> lobes_;
    Vec3d view_;
    const EnvironmentMap* map_;
    glm::dmat3 to_map_{1};  // from the shading frame
};

EnvironmentRays::EnvironmentRays(const ShadowTracer& tracer, const Environment& environment,
                                 std::span<const MaterialLobes> materials)
    : tracer_(&tracer), environment_(&environment), lobes_(materials) {
    for (const MaterialLobes& material : materials) {
        Sets& sets = materials_.emplace_back();
        for (std::size_t i = 0; i < material.lobes().size(); ++i) {
            const auto alike = [&](std::size_t other) {
                return spread_alike(material.lobes()[other], material.lobes()[i]);
            };
            if (is_mirror(material.lobes()[i].shape)) {
                sets.mirror = true;
            } else if (std::none_of(sets.lobes.begin(), sets.lobes.end(), alike)) {
                sets.lobes.push_back(i);
            }
        }
    }
}

void EnvironmentRays::trace(const Hits& hits, std::span<const std::size_t> lit, const RayPhase& phase,
                            std::uint32_t seed) {
    if (phase.first) {
        directions_.clear();
        weights_.clear();
        spot_weights_.clear();
        visible_.clear();
        runs_.clear();
    }
    rays_.clear();
    const std::size_t before = visible_.size();
    for (const std::size_t hit : lit) {
        runs_.push_back(draw(hits, hit, phase, seed));
    }
    visible_.resize(directions_.size());
    tracer_->visibility(rays_, std::span(visible_).subspan(before));
    rays_traced_ += rays_.size();
}

EnvironmentRays::Run EnvironmentRays::draw(const Hits& hits, std::size_t hit, const RayPhase& phase,
                                           std::uint32_t seed) {
    const Sets& sets = materials_[hits.material[hit]];
    const Vec3d view = hits.view(hit);
    shapes_.clear();
    for (const std::size_t lobe : sets.lobes) {
        shapes_.push_back(sampled_shape(lobes_[hits.material[hit]].shape(lobe, hits.widths(hit)[lobe])));
    }
    const Directions directions(shapes_, view, environment_->map(), hits.frame[hit]);
    const RayStart start(hits.frame[hit], hits.shadow_origin[hit], Vec3d(0));
    const auto push = [&](const Vec3d& direction, double density) {
        directions_.emplace_back(direction);
        const Vec3d world = hits.frame[hit].to_world(direction);
        const Rgb smooth = environment_->smooth_radiance(world);
        weights_.push_back(smooth / static_cast<float>(density));
        spot_weights_.push_back((environment_->radiance(world) - smooth) / static_cast<float>(density));
        rays_.push_back(start.along(direction));
    };
    Run run = {directions_.size(), 0, {}};
    const std::uint32_t first = phase.first_point + (hits.sample[hit] - phase.first_sample) * phase.rays_per_hit;
    for (std::size_t set = 0; set < directions.set_count(); ++set) {
        const std::uint32_t own_seed = hash(seed, static_cast<std::uint32_t>(set));
        for (std::uint32_t ray = 0; ray < phase.rays_per_hit; ++ray) {
            const Vec3d direction = directions.sample(set, sobol(shuffled(first + ray, own_seed), own_seed));
            if (direction.z > 0) {
                push(direction, directions.density(direction));
            }
        }
    }
    run.end = directions_.size();
    if (sets.mirror && phase.first) {
        run.mirror = directions_.size();
        push(mirrored(view), 1);
    }
    return run;
}

bool EnvironmentRays::all_free() const {
    return std::all_of(visible_.begin(), visible_.end(), [](const Rgb& visible) { return visible == Rgb(1); });
}

EnvironmentRays::Sums EnvironmentRays::sum(const Hits& hits, std::span<const std::size_t> lit, std::size_t lit_index,
                                           std::size_t lobe, bool split) const {
    const std::size_t hit = lit[lit_index];
    const LobeShape shape = lobes_[hits.material[hit]].shape(lobe, hits.widths(hit)[lobe]);
    const bool mirror = is_mirror(shape);
    const Vec3d view = hits.view(hit);
    Sums result;
    const auto add_to = [&](RaySums& sums, std::size_t ray, const Vec3d& weighted) {
        sums.add(weighted, visible_[ray]);
    };
    const auto add = [&](std::size_t ray, double value) {
        if (split) {
            add_to(result.smooth, ray, value * Vec3d(weights_[ray]));
            add_to(result.spots, ray, value * Vec3d(spot_weights_[ray]));
        } else {
            add_to(result.smooth, ray, value * Vec3d(weights_[ray] + spot_weights_[ray]));
        }
    };
    for (std::size_t i = lit_index; i < runs_.size(); i += lit.size()) {
        if (mirror && runs_[i].mirror) {
            add(*runs_[i].mirror, 1);
        }
        for (std::size_t ray = runs_[i].begin; ray < runs_[i].end && !mirror; ++ray) {
            add(ray, lobe_value(shape, Vec3d(directions_[ray]), view));
        }
    }
    return result;
}

}  // namespace shlight
