// SPDX-License-Identifier: MIT
#include "shadows/environment_rays.h"

#include <algorithm>
#include <array>

#include "environment/map_lookup.h"
#include "shadows/ray_start.h"
#include "shlight/sampling.h"

namespace shlight {
namespace {

constexpr std::size_t kLookedUpAtOnce = 256;
static_assert(kLookedUpAtOnce % kLookupLanes == 0);

}  // namespace

/// Directions from one hit, and how densely the sets draw them.
class EnvironmentRays::Directions {
  public:
    Directions(std::span<const LobeShape> lobes, const Vec3d& view, const EnvironmentMap* map,
               const ShadingFrame& frame)
        : lobes_(lobes), view_(view), map_(lobes.empty() ? nullptr : map) {
        if (map != nullptr) {
            to_map_ = glm::dmat3(map->to_map(frame.x), map->to_map(frame.y), map->to_map(frame.z));
        }
    }

    std::size_t set_count() const { return lobes_.size() + (map_ != nullptr ? 1 : 0); }
    /// May lie below the horizon.
    Vec3d sample(std::size_t set, const glm::dvec2& point) const {
        const bool of_map = map_ != nullptr && set == lobes_.size();
        return of_map ? map_->sampler.sample(point) * to_map_ : sample_lobe(lobes_[set], view_, point);
    }
    /// By the sets of lobes.
    double density_of_lobes(const Vec3d& direction) const {
        double sum = 0;
        for (const LobeShape& lobe : lobes_) {
            sum += lobe_density(lobe, view_, direction);
        }
        return sum;
    }
    /// From the shading frame.
    const glm::dmat3& to_map() const { return to_map_; }

  private:
    std::span<const LobeShape> lobes_;
    Vec3d view_;
    const EnvironmentMap* map_;
    glm::dmat3 to_map_{1};
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
        set_stride_ = std::max(set_stride_, sets.lobes.size() + 1);
    }
}

void EnvironmentRays::start(const Hits& hits, std::span<const std::size_t> lit) {
    hits_ = &hits;
    lit_ = lit;
    directions_.clear();
    visible_.clear();
    rays_.clear();
    runs_.assign(2 * lit.size(), {});
}

EnvironmentRays::Directions EnvironmentRays::directions_from(std::size_t hit) {
    const std::uint32_t material = hits_->material[hit];
    shapes_.clear();
    for (const std::size_t lobe : materials_[material].lobes) {
        shapes_.push_back(sampled_shape(lobes_[material].shape(lobe, hits_->widths(hit)[lobe])));
    }
    return Directions(shapes_, hits_->view(hit), environment_->map(), hits_->frame[hit]);
}

void EnvironmentRays::draw(const LitRange& pixel, const RayPhase& phase, std::uint32_t seed) {
    sequences_.clear();
    for (std::uint32_t set = 0; set < set_stride_; ++set) {
        sequences_.emplace_back(hash(seed, set));
    }
    for (std::size_t i = pixel.begin; i < pixel.end; ++i) {
        draw_hit(i, phase);
    }
}

void EnvironmentRays::draw_hit(std::size_t lit_index, const RayPhase& phase) {
    const std::size_t hit = lit_[lit_index];
    const RayStart start(hits_->frame[hit], hits_->shadow_origin[hit], Vec3d(0));
    const auto push = [&](const Vec3d& direction) {
        directions_.emplace_back(direction);
        rays_.push_back(start.along(direction));
    };
    const Directions directions = directions_from(hit);
    const std::uint32_t first = phase.first_point + (hits_->sample[hit] - phase.first_sample) * phase.rays_per_hit;
    Run& own = run(lit_index, phase.first);
    own.begin = directions_.size();
    for (std::size_t set = 0; set < directions.set_count(); ++set) {
        for (std::uint32_t ray = 0; ray < phase.rays_per_hit; ++ray) {
            const Vec3d direction = directions.sample(set, sequences_[set].point(first + ray));
            if (direction.z > 0) {
                push(direction);
            }
        }
    }
    own.mirror = directions_.size();
    if (materials_[hits_->material[hit]].mirror && phase.first) {
        push(mirrored(hits_->view(hit)));
    }
    own.end = directions_.size();
}

void EnvironmentRays::trace() {
    visible_.resize(directions_.size());
    tracer_->visibility(rays_, std::span(visible_).last(rays_.size()));
    rays_traced_ += rays_.size();
    rays_.clear();
}

bool EnvironmentRays::all_free(const LitRange& pixel) const {
    const std::size_t begin = run(pixel.begin, true).begin;
    const auto own = std::span(visible_).subspan(begin, run(pixel.end - 1, true).end - begin);
    return std::all_of(own.begin(), own.end(), [](const Rgb& visible) { return visible == Rgb(1); });
}

void EnvironmentRays::weigh(std::span<const LitRange> pixels) {
    asked_.clear();
    for (const LitRange& pixel : pixels) {
        for (std::size_t i = pixel.begin; i < pixel.end; ++i) {
            const Directions directions = directions_from(lit_[i]);
            for (const Run& own : {run(i, true), run(i, false)}) {
                for (std::size_t ray = own.begin; ray < own.end; ++ray) {
                    const bool mirror = ray >= own.mirror;
                    const Vec3d direction(directions_[ray]);
                    asked_.push_back({ray, Vec3f(directions.to_map() * direction),
                                      static_cast<float>(mirror ? 1.0 : directions.density_of_lobes(direction)),
                                      mirror});
                }
            }
        }
    }
    weights_.resize(directions_.size());
    if (environment_->map() != nullptr) {
        weigh_map(*environment_->map());
        return;
    }
    const Rgb radiance = environment_->radiance(Vec3d(0, 0, 1));
    for (const Asked& asked : asked_) {
        weights_[asked.ray] = {radiance / asked.lobe_density, Rgb(0)};
    }
}

void EnvironmentRays::weigh_map(const EnvironmentMap& map) {
    std::array<std::array<float, kLookedUpAtOnce>, 10> lanes{};
    auto& [x, y, z, red, green, blue, spot_red, spot_green, spot_blue, density] = lanes;
    for (std::size_t first = 0; first < asked_.size(); first += kLookedUpAtOnce) {
        const std::size_t count = std::min(asked_.size() - first, kLookedUpAtOnce);
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3f& direction = asked_[first + i].direction;
            x[i] = direction.x;
            y[i] = direction.y;
            z[i] = direction.z;
        }
        look_up(map, {x.data(), y.data(), z.data()}, count,
                {{red.data(), green.data(), blue.data()},
                 {spot_red.data(), spot_green.data(), spot_blue.data()},
                 density.data()});
        for (std::size_t i = 0; i < count; ++i) {
            const Asked& asked = asked_[first + i];
            const float weight = 1 / (asked.lobe_density + (asked.mirror ? 0 : density[i]));
            weights_[asked.ray] = {weight * Rgb(red[i], green[i], blue[i]),
                                   weight * Rgb(spot_red[i], spot_green[i], spot_blue[i])};
        }
    }
}

EnvironmentRays::Sums EnvironmentRays::sum(std::size_t lit_index, std::size_t lobe, bool split) const {
    const std::size_t hit = lit_[lit_index];
    const LobeShape shape = lobes_[hits_->material[hit]].shape(lobe, hits_->widths(hit)[lobe]);
    const bool mirror = is_mirror(shape);
    const Vec3d view = hits_->view(hit);
    Sums sums;
    for (const Run& own : {run(lit_index, true), run(lit_index, false)}) {
        for (std::size_t ray = mirror ? own.mirror : own.begin; ray < (mirror ? own.end : own.mirror); ++ray) {
            const double value = mirror ? 1.0 : lobe_value(shape, Vec3d(directions_[ray]), view);
            const Weight& weight = weights_[ray];
            sums.smooth.add(value * Vec3d(split ? weight.smooth : weight.smooth + weight.spots), visible_[ray]);
            if (split) {
                sums.spots.add(value * Vec3d(weight.spots), visible_[ray]);
            }
        }
    }
    return sums;
}

}  // namespace shlight
