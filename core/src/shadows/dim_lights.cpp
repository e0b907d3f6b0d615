// SPDX-License-Identifier: MIT
#include "shadows/dim_lights.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>

#include "lights/whole_rectangle.h"
#include "shadows/ray_start.h"

namespace shlight {
namespace {

/// Rays that are traced together, at least.
constexpr std::size_t kQuestionsAtOnce = 512;
/// What tells shared rays from those of one light.
constexpr std::uint32_t kSharedSeed = 0;

struct FoundMember {
    std::size_t number;  ///< of the member
    double into;         ///< how far into it, 0 … 1
    double length;       ///< of it
};

/// The member at a share of the total length of a line of members.
template <class Members>
FoundMember find(const Members& members, double share) {
    const double place = share * members.back().up_to;
    const auto found = std::partition_point(members.begin(), members.end() - 1,
                                            [&](const auto& member) { return member.up_to <= place; });
    const double before = found == members.begin() ? 0.0 : (found - 1)->up_to;
    const double length = found->up_to - before;
    return {static_cast<std::size_t>(found - members.begin()), std::clamp((place - before) / length, 0.0, 1.0), length};
}

}  // namespace

void DimLights::start(std::span<const Light* const> lights, const DirectLight& unshadowed, const SampleRange& samples) {
    lights_ = lights;
    unshadowed_ = &unshadowed;
    samples_ = samples;
    may_share_.clear();
    for (std::size_t i = 0; i < lights.size(); ++i) {
        // Shares are those of light that adds up; and rays to a mesh take another way.
        const bool adds = glm::all(glm::greaterThanEqual(unshadowed.light(i).strength, Rgb(0)));
        const bool is_mesh = std::holds_alternative<MeshLight>(*lights[i]);
        may_share_.push_back(adds && !is_mesh && traits_of(*lights[i]).casts_shadows ? 1 : 0);
    }
}

bool DimLights::is_dim(std::size_t light, std::size_t pixel) const {
    return may_share_[light] != 0 && samples_.shadow_rays > 0 &&
           budget_->rays(budget_->of_group(light, pixel), pixel, samples_) < 1;
}

void DimLights::add(const ShadingPoints& points, std::span<const std::uint32_t> seeds, Hits& hits) {
    points_ = &points;
    radiance_.assign(points.size(), Rgb(0));
    apart_.reset(hits.pixel_count());
    asked_.clear();
    rays_.start();
    for (std::size_t pixel = 0; pixel < hits.pixel_count(); ++pixel) {
        const float own = gather(pixel);
        if (dim_.empty()) {
            continue;
        }
        const auto hit_count = static_cast<double>(hits.pixel_begin[pixel + 1] - hits.pixel_begin[pixel]);
        const double rays = budget_->rays(own, pixel, samples_) * hit_count;
        ask(pixel, static_cast<std::size_t>(std::ceil(rays)), hash(hash(seeds[pixel], samples_.first), kSharedSeed),
            hits);
        if (rays_.count() >= kQuestionsAtOnce) {
            finish(hits);
        }
    }
    finish(hits);
}

float DimLights::gather(std::size_t pixel) {
    dim_.clear();
    float sum = 0;
    for (std::size_t i = 0; i < lights_.size(); ++i) {
        const float own = budget_->of_group(i, pixel);
        if (own > 0 && is_dim(i, pixel)) {
            sum += own;
            dim_.push_back({i, sum});
        }
    }
    return sum;
}

void DimLights::ask(std::size_t pixel, std::size_t questions, std::uint32_t seed, const Hits& hits) {
    const std::size_t before = rays_.count();
    const SobolSequence places(seed);
    std::size_t gathered = lights_.size();
    for (std::size_t i = 0; i < questions; ++i) {
        const glm::dvec2 point = lattice_point(i, questions, seed);
        const FoundMember drawn = find(dim_, point.x);
        const std::size_t light = dim_[drawn.number].index;
        const LightRadiance unshadowed = unshadowed_->light(light);
        if (light != gathered) {
            // The questions come light by light.
            gather_points(pixel, unshadowed);
            gathered = light;
        }
        const FoundMember at = find(dim_points_, point.y);
        const auto own_hits = points_->hits_of(dim_points_[at.number].index);
        const auto number = static_cast<std::size_t>(at.into * static_cast<double>(own_hits.size()));
        const std::size_t hit = own_hits[std::min(number, own_hits.size() - 1)];
        ask_hit(*lights_[light], unshadowed, hit, places.point(static_cast<std::uint32_t>(i)),
                at.length / static_cast<double>(own_hits.size()), hits);
    }
    asked_.push_back({pixel, before, rays_.count()});
    add_unblocked(pixel);
}

void DimLights::gather_points(std::size_t pixel, const LightRadiance& unshadowed) {
    dim_points_.clear();
    float sum = 0;
    for (std::size_t point = points_->pixel_begin[pixel]; point < points_->pixel_begin[pixel + 1]; ++point) {
        const float own = budget_->of_point(unshadowed, point);
        if (own > 0) {
            sum += own;
            dim_points_.push_back({point, sum});
        }
    }
}

void DimLights::ask_hit(const Light& light, const LightRadiance& unshadowed, std::size_t hit, const glm::dvec2& place,
                        double density, const Hits& hits) {
    const MaterialLobes& material = materials_[hits.material[hit]];
    const bool mirrors = std::any_of(material.lobes().begin(), material.lobes().end(),
                                     [](const Lobe& lobe) { return is_mirror(lobe.shape); });
    const auto rectangle = mirrors ? std::nullopt : WholeRectangle::see(light, hits.frame[hit], hits.error[hit]);
    if (!rectangle) {
        if (!seen_.look(light, hits.frame[hit], hits.error[hit])) {
            return;
        }
        sampler_.reset(seen_);
    }
    const RayStart start(hits.frame[hit], hits.shadow_origin[hit], clearance(light, hits.frame[hit]));
    const auto ask = [&](const Rgb& value, const Vec3d& direction, double distance) {
        if (value != Rgb(0)) {
            rays_.ask(value, traits_of(light).group, start.towards(direction, distance));
        }
    };
    const LightSample sample = rectangle ? rectangle->sample(hits.frame[hit], place) : sampler_.sample(place);
    const Vec3d view = hits.view(hit);
    const double weight = rectangle ? sample.weight : sample.weight * seen_.profile().factor(sample.direction);
    const Rgb strength = unshadowed.strength / static_cast<float>(density);
    Rgb value(0);
    for (std::size_t lobe = 0; lobe < material.lobes().size(); ++lobe) {
        const std::size_t i = lobe * points_->size() + points_->of_hit[hit];
        const Rgb reflected = strength * glm::abs(hits.weight(hit, lobe));
        const LobeShape shape = material.shape(lobe, hits.widths(hit)[lobe]);
        if (!(unshadowed.values[i] > 0)) {
            continue;
        }
        if (is_mirror(shape)) {
            const std::optional<double> distance = sampler_.meets(mirrored(view));
            ask(reflected * unshadowed.values[i], mirrored(view), distance.value_or(sample.distance));
        } else {
            value += reflected * static_cast<float>(weight * lobe_value(shape, sample.direction, view));
        }
    }
    ask(value, sample.direction, sample.distance);
}

void DimLights::add_unblocked(std::size_t pixel) {
    for (std::size_t point = points_->pixel_begin[pixel]; point < points_->pixel_begin[pixel + 1]; ++point) {
        for (const Member& member : dim_) {
            const LightRadiance unshadowed = unshadowed_->light(member.index);
            const std::uint32_t group = traits_of(*lights_[member.index]).group;
            Rgb sum(0);
            for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
                const Rgb own = points_->weight(point, lobe) * unshadowed[lobe * points_->size() + point];
                sum += own;
                if (!apart_.empty()) {
                    apart_.add(pixel, apart_.parts().kind(points_->material[point], lobe), group,
                               static_cast<float>(points_->hit_count(point)) * own);
                }
            }
            radiance_[point] += sum;
        }
    }
}

void DimLights::finish(Hits& hits) {
    rays_.trace();
    for (const SharedRays::Asked& asked : asked_) {
        const SharedRays::Share share = rays_.share(asked.begin, asked.end);
        Rgb sum(0);
        for (std::size_t hit = hits.pixel_begin[asked.pixel]; hit < hits.pixel_begin[asked.pixel + 1]; ++hit) {
            const Rgb& radiance = radiance_[points_->of_hit[hit]];
            hits.radiance[hit] += share.seen * radiance;
            sum += radiance;
        }
        if (!apart_.empty()) {
            rays_.keep_apart(asked, share, apart_.of(asked.pixel), hits.apart);
        }
        hits.add_shared(asked.pixel, share.variance * sum * sum, share.obstructed);
    }
    asked_.clear();
    rays_.start();
}

}  // namespace shlight
