// SPDX-License-Identifier: MIT
#include "shadows/environment_rays.h"

#include <algorithm>
#include <array>

#include "environment/map_lookup.h"

namespace shlight {
namespace {

constexpr std::size_t kLookedUpAtOnce = 256;
static_assert(kLookedUpAtOnce % kLookupLanes == 0);

}  // namespace

EnvironmentRays::EnvironmentRays(ShadowTracer& tracer, const Environment& environment,
                                 std::span<const MaterialLobes> materials)
    : tracer_(&tracer), environment_(&environment), lobes_(materials), points_(0) {
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
    points_ = PixelPoints(set_stride_);
}

void EnvironmentRays::start(const Hits& hits, std::span<const std::size_t> lit) {
    hits_ = &hits;
    lit_ = lit;
    directions_.clear();
    rays_.clear();
    lookups_.clear();
    runs_.assign(lit.size(), {});
}

void EnvironmentRays::find_shapes(std::size_t hit) {
    const std::uint32_t material = hits_->material[hit];
    shapes_.clear();
    for (const std::size_t lobe : materials_[material].lobes) {
        shapes_.push_back(sampled_shape(lobes_[material].shape(lobe, hits_->widths(hit)[lobe])));
    }
}

void EnvironmentRays::draw(const LitRange& pixel, const SampleRange& samples, std::uint32_t seed) {
    points_.start(samples, hits_->sample[lit_[pixel.begin]], hits_->sample[lit_[pixel.end - 1]], seed);
    for (std::size_t i = pixel.begin; i < pixel.end; ++i) {
        draw_hit(i, samples.shadow_rays);
    }
}

void EnvironmentRays::draw_hit(std::size_t lit_index, std::uint32_t rays) {
    const std::size_t hit = lit_[lit_index];
    const ShadowRaySpawner start(hits_->frame[hit], hits_->shadow_origin[hit], Vec3d(0));
    find_shapes(hit);
    Run& own = runs_[lit_index];
    own.begin = directions_.size();
    for (std::size_t set = 0; set < shapes_.size(); ++set) {
        draw_set(start, hit, set, rays);
    }
    if (environment_->map() != nullptr && !shapes_.empty()) {
        draw_map(start, hit, rays);
    }
    own.mirror = directions_.size();
    if (materials_[hits_->material[hit]].mirror) {
        push(start, mirrored(hits_->view(hit)));
    }
    own.end = directions_.size();
}

void EnvironmentRays::draw_set(const ShadowRaySpawner& start, std::size_t hit, std::size_t set, std::uint32_t rays) {
    const PixelPoints::Square square = points_.of(set, hits_->sample[hit]);
    alignas(64) std::array<float, kRaysAtOnce> x, y, z;  // all are written before they are read
    for (std::uint32_t first = 0; first < rays; first += kRaysAtOnce) {
        const std::uint32_t count = std::min(rays - first, kRaysAtOnce);
        sample_lobe_rays(shapes_[set], hits_->view(hit), square.u + first, square.v + first, count,
                         {x.data(), y.data(), z.data()});
        for (std::uint32_t i = 0; i < count; ++i) {
            push(start, Vec3d(x[i], y[i], z[i]));
        }
    }
}

void EnvironmentRays::draw_map(const ShadowRaySpawner& start, std::size_t hit, std::uint32_t rays) {
    const EnvironmentMap& map = *environment_->map();
    const ShadingFrame& frame = hits_->frame[hit];
    const glm::dmat3 to_map(map.to_map(frame.x), map.to_map(frame.y), map.to_map(frame.z));
    const PixelPoints::Square square = points_.of(shapes_.size(), hits_->sample[hit]);
    for (std::uint32_t i = 0; i < rays; ++i) {
        push(start, map.sampler.sample({square.u[i], square.v[i]}) * to_map);
    }
}

void EnvironmentRays::push(const ShadowRaySpawner& start, const Vec3d& direction) {
    if (direction.z > 0) {
        const Ray ray = start.along(direction);
        directions_.push_back(ray.direction);
        rays_.push_back(ray);
    }
}

void EnvironmentRays::trace() {
    visible_.resize(directions_.size());
    tracer_->visibility(rays_, visible_);
}

bool EnvironmentRays::any_occluded(const LitRange& pixel) const {
    const std::size_t begin = runs_[pixel.begin].begin;
    const auto own = std::span(visible_).subspan(begin, runs_[pixel.end - 1].end - begin);
    return std::any_of(own.begin(), own.end(), [](const Rgb& visible) { return visible != Rgb(1); });
}

void EnvironmentRays::gather(std::size_t lit_index) {
    weighed_.clear();
    const Run& own = runs_[lit_index];
    weighed_.add(own.begin, own.mirror, [&](std::size_t ray) -> const Vec3f& { return directions_[ray]; });
}

void EnvironmentRays::weigh(const LitRange& pixel) {
    for (std::size_t i = pixel.begin; i < pixel.end; ++i) {
        weigh_hit(i);
    }
}

void EnvironmentRays::find_weights() {
    weights_.resize(directions_.size());
    if (environment_->map() != nullptr) {
        weigh_map(*environment_->map());
        return;
    }
    const Rgb radiance = environment_->radiance(Vec3d(0, 0, 1));
    for (const Lookup& lookup : lookups_) {
        weights_[lookup.ray] = {radiance / lookup.lobe_density, Rgb(0)};
    }
}

void EnvironmentRays::weigh_hit(std::size_t lit_index) {
    const std::size_t hit = lit_[lit_index];
    const EnvironmentMap* map = environment_->map();
    const auto add = [&](std::size_t ray, float density, bool mirror) {
        const Vec3d direction(directions_[ray]);
        lookups_.push_back({ray, Vec3f(map != nullptr ? map->to_map(direction) : direction), density, mirror});
    };
    gather(lit_index);
    const std::size_t first = lookups_.size();
    for (std::size_t i = 0; i < weighed_.size(); ++i) {
        add(weighed_.number(i), 0, false);
    }
    find_shapes(hit);
    for (const LobeShape& shape : shapes_) {
        weighed_.weigh(shape, hits_->frame[hit], hits_->view(hit), true);
        for (std::size_t i = 0; i < weighed_.size(); ++i) {
            lookups_[first + i].lobe_density += weighed_.density(i);
        }
    }
    for (std::size_t ray = runs_[lit_index].mirror; ray < runs_[lit_index].end; ++ray) {
        add(ray, 1, true);
    }
}

void EnvironmentRays::weigh_map(const EnvironmentMap& map) {
    std::array<std::array<float, kLookedUpAtOnce>, 10> lanes{};
    auto& [x, y, z, red, green, blue, spot_red, spot_green, spot_blue, density] = lanes;
    for (std::size_t first = 0; first < lookups_.size(); first += kLookedUpAtOnce) {
        const std::size_t count = std::min(lookups_.size() - first, kLookedUpAtOnce);
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3f& direction = lookups_[first + i].direction;
            x[i] = direction.x;
            y[i] = direction.y;
            z[i] = direction.z;
        }
        look_up(map, {x.data(), y.data(), z.data()}, count,
                {{red.data(), green.data(), blue.data()},
                 {spot_red.data(), spot_green.data(), spot_blue.data()},
                 density.data()});
        for (std::size_t i = 0; i < count; ++i) {
            const Lookup& lookup = lookups_[first + i];
            const float weight = 1 / (lookup.lobe_density + (lookup.mirror ? 0 : density[i]));
            weights_[lookup.ray] = {weight * Rgb(red[i], green[i], blue[i]),
                                    weight * Rgb(spot_red[i], spot_green[i], spot_blue[i])};
        }
    }
}

EnvironmentRays::Sums EnvironmentRays::sum(std::size_t lit_index, std::size_t lobe, bool split) {
    const std::size_t hit = lit_[lit_index];
    const LobeShape shape = lobes_[hits_->material[hit]].shape(lobe, hits_->widths(hit)[lobe]);
    Sums sums;
    const auto add = [&](std::size_t ray, double value) {
        const Weight& weight = weights_[ray];
        sums.smooth.add(value * Vec3d(split ? weight.smooth : weight.smooth + weight.spots), visible_[ray]);
        if (split) {
            sums.spots.add(value * Vec3d(weight.spots), visible_[ray]);
        }
    };
    if (is_mirror(shape)) {
        for (std::size_t ray = runs_[lit_index].mirror; ray < runs_[lit_index].end; ++ray) {
            add(ray, 1);
        }
        return sums;
    }
    gather(lit_index);
    weighed_.weigh(shape, hits_->frame[hit], hits_->view(hit), false);
    for (std::size_t i = 0; i < weighed_.size(); ++i) {
        add(weighed_.number(i), double{weighed_.value(i)});
    }
    return sums;
}

}  // namespace shlight
