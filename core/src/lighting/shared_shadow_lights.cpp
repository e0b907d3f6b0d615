// SPDX-License-Identifier: MIT
#include "lighting/shared_shadow_lights.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <variant>

#include "lighting/ray_sums.h"

namespace shlight {
namespace {

/// Rays that are traced together, at least.
constexpr std::size_t kRaysTogether = 512;
/// Seed that separates shared rays from those of one light.
constexpr std::uint32_t kSharedSeed = 0;
/// Share of what is seen of all groups that is seen of each, at least: hits may have light of no other.
constexpr float kLeastOfGroup = 1e-6F;

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

void SharedShadowLights::start(std::span<const Light> lights, std::span<const UnshadowedLight> unshadowed,
                               const SampleRange& samples, std::size_t begin, std::size_t end) {
    lights_ = lights;
    begin_ = begin;
    end_ = end;
    unshadowed_ = unshadowed;
    samples_ = samples;
    may_share_.clear();
    for (const Light& light : lights.subspan(begin, end - begin)) {
        // Shares are those of light that adds up; and rays to a mesh take another way.
        const bool adds = glm::all(glm::greaterThanEqual(strength_of(light), Rgb(0)));
        const bool is_mesh = std::holds_alternative<MeshLight>(light);
        may_share_.push_back(samples.shares_rays && adds && !is_mesh && traits_of(light).casts_shadows ? 1 : 0);
    }
}

bool SharedShadowLights::is_dim(std::size_t light, std::size_t pixel) const {
    return may_share_[light - begin_] != 0 && samples_.shadow_rays > 0 && budget_->rays(light, pixel, samples_) < 1;
}

void SharedShadowLights::add(const ShadingPoints& points, std::span<const std::uint32_t> seeds, Hits& hits) {
    points_ = &points;
    radiance_.assign(points.size(), Rgb(0));
    apart_.reset(points.size());
    for (std::size_t first = 0; first < hits.pixel_count(); first += kPixelsAtOnce) {
        const std::span some = std::span(gathered_).first(std::min(kPixelsAtOnce, hits.pixel_count() - first));
        gather(first, some);
        for (std::size_t pixel = first; pixel < first + some.size(); ++pixel) {
            const DimLights& own = some[pixel - first];
            dim_ = own.members;
            if (dim_.empty()) {
                continue;
            }
            const auto hit_count = static_cast<double>(hits.pixel_begin[pixel + 1] - hits.pixel_begin[pixel]);
            request(pixel, static_cast<std::size_t>(std::ceil(own.rays * hit_count)),
                    hash(hash(seeds[pixel], samples_.first_point), kSharedSeed), hits);
            if (rays_.size() >= kRaysTogether) {
                finish(hits);
            }
        }
    }
    finish(hits);
}

/// Light by light, as the budget is stored.
void SharedShadowLights::gather(std::size_t first, std::span<DimLights> pixels) const {
    for (DimLights& dim : pixels) {
        dim.members.clear();
        dim.rays = 0;
    }
    for (std::size_t i = begin_; i < end_; ++i) {
        for (std::size_t k = 0; may_share_[i - begin_] != 0 && samples_.shadow_rays > 0 && k < pixels.size(); ++k) {
            const float own = budget_->of_group(i, first + k);
            if (!(own > 0)) {
                continue;
            }
            if (const float rays = budget_->rays(i, first + k, samples_); rays < 1) {
                std::vector<Member>& members = pixels[k].members;
                members.push_back({i, own + (members.empty() ? 0 : members.back().up_to)});
                pixels[k].rays += double{rays};
            }
        }
    }
}

void SharedShadowLights::request(std::size_t pixel, std::size_t count, std::uint32_t seed, const Hits& hits) {
    const std::size_t before = rays_.size();
    const SobolSequence places(seed);
    std::size_t gathered = lights_.size();
    for (std::size_t i = 0; i < count; ++i) {
        const glm::dvec2 point = lattice_point(i, count, seed);
        const FoundMember drawn = find(dim_, point.x);
        const std::size_t light = dim_[drawn.number].index;
        const UnshadowedLight& unshadowed = unshadowed_[light];
        if (light != gathered) {
            // The samples come light by light.
            gather_points(pixel, unshadowed);
            gathered = light;
        }
        const FoundMember at = find(dim_points_, point.y);
        const auto own_hits = points_->hits_of(dim_points_[at.number].index);
        const auto number = static_cast<std::size_t>(at.into * static_cast<double>(own_hits.size()));
        const std::size_t hit = own_hits[std::min(number, own_hits.size() - 1)];
        request_from(hit, light, places.point(static_cast<std::uint32_t>(i)),
                     at.length / static_cast<double>(own_hits.size()), hits);
    }
    pixels_.push_back({pixel, before, rays_.size()});
    add_unblocked(pixel);
}

void SharedShadowLights::gather_points(std::size_t pixel, const UnshadowedLight& unshadowed) {
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

void SharedShadowLights::request_from(std::size_t hit, std::size_t light, const glm::dvec2& place, double density,
                                      const Hits& hits) {
    target_.set(lights_[light]);
    target_.clear();
    if (!target_.add(hits, hit)) {
        return;
    }
    target_.aim(hits, hit, 0, true);
    const std::size_t before = rays_.size();
    u_[0] = static_cast<float>(place.x);
    v_[0] = static_cast<float>(place.y);
    target_.draw(u_.data(), v_.data(), 1, rays_);
    if (rays_.size() == before) {
        return;
    }
    terminator_.lift(hits, hit, target_, before, rays_);
    shadow_samples_.push_back(
        {hit, light, density, static_cast<float>(hits.let_in(hit, Vec3d(rays_.drawn[before].way)))});
}

Rgb SharedShadowLights::value(std::size_t sample, const Hits& hits) const {
    const auto& [hit, light, density, let_in] = shadow_samples_[sample];
    const DrawnRay& drawn = rays_.drawn[sample];
    const Vec3d direction = hits.frame[hit].to_local(glm::normalize(Vec3d(drawn.way)));
    const double weight = double{drawn.radiance} / (drawn.light_density * density);
    const MaterialLobes& material = materials_[hits.material[hit]];
    // In double, as the density of a very dim light is too small to divide by in float.
    Vec3d sum(0);
    for (std::size_t lobe = 0; lobe < material.lobes().size(); ++lobe) {
        if (unshadowed_[light][lobe * points_->size() + points_->of_hit[hit]] != Rgb(0)) {
            const LobeShape shape = material.shape(lobe, hits.forms(hit)[lobe]);
            sum += Vec3d(glm::abs(hits.weight(hit, lobe))) * (weight * lobe_value(shape, direction, hits.view(hit)));
        }
    }
    return Rgb(sum * Vec3d(strength_of(lights_[light])));
}

void SharedShadowLights::add_unblocked(std::size_t pixel) {
    for (std::size_t point = points_->pixel_begin[pixel]; point < points_->pixel_begin[pixel + 1]; ++point) {
        for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
            const Rgb& weight = points_->weight(point, lobe);
            if (weight == Rgb(0)) {
                continue;
            }
            Rgb sum(0);
            for (const Member& member : dim_) {
                sum += unshadowed_[member.index][lobe * points_->size() + point];
            }
            radiance_[point] += weight * sum;
        }
        if (!apart_.empty()) {
            add_parts(point);
        }
    }
}

void SharedShadowLights::add_parts(std::size_t point) {
    for (const Member& member : dim_) {
        const std::uint32_t group = traits_of(lights_[member.index]).group;
        for (std::size_t lobe = 0; lobe < lobe_stride_; ++lobe) {
            apart_.add(point, apart_.parts().kind(points_->material[point], lobe, points_->path[point]), group,
                       points_->weight(point, lobe) * unshadowed_[member.index][lobe * points_->size() + point]);
        }
    }
}

void SharedShadowLights::finish(Hits& hits) {
    rays_.visible.resize(rays_.size());
    values_.assign(rays_.size(), Rgb(0));
    tracer_->visibility(rays_.rays.all(), rays_.visible);
    for (std::size_t i = 0; i < rays_.visible.size(); ++i) {
        rays_.visible[i] *= shadow_samples_[i].let_in;
    }
    for (const PixelSamples& own : pixels_) {
        const Share seen = share(own, hits);
        Rgb sum(0);
        for (std::size_t hit = hits.pixel_begin[own.pixel]; hit < hits.pixel_begin[own.pixel + 1]; ++hit) {
            const Rgb& radiance = radiance_[points_->of_hit[hit]];
            hits.radiance[hit] += seen.seen * radiance;
            sum += radiance;
        }
        if (!apart_.empty()) {
            keep_apart(own, seen, hits);
        }
        hits.shared_noise[own.pixel] += seen.variance * sum * sum;
        hits.visibility[own.pixel] |= seen.lights;
    }
    pixels_.clear();
    shadow_samples_.clear();
    rays_.clear();
}

SharedShadowLights::Share SharedShadowLights::share(const PixelSamples& own, const Hits& hits) {
    Share share;
    for (std::size_t i = own.begin; i < own.end; ++i) {
        share.lights.add(shadow_samples_[i].light, rays_.visible[i]);
    }
    if (share.lights.hidden == 0) {
        share.seen = Rgb(1);
        return share;
    }
    Vec3d all(0);
    Vec3d seen(0);
    for (std::size_t i = own.begin; i < own.end; ++i) {
        values_[i] = value(i, hits);
        all += values_[i];
        seen += values_[i] * rays_.visible[i];
    }
    share.seen = Rgb(quotient(seen, all));
    for (std::size_t i = own.begin; i < own.end; ++i) {
        const Vec3d off = quotient(Vec3d((rays_.visible[i] - share.seen) * values_[i]), all);
        share.variance += Rgb(off * off);
    }
    return share;
}

void SharedShadowLights::keep_apart(const PixelSamples& own, const Share& share, Hits& hits) {
    const std::size_t groups = apart_.parts().count - kLightKinds;
    const std::size_t end = hits.pixel_begin[own.pixel + 1];
    std::vector<Rgb> all(groups, Rgb(0));
    for (std::size_t hit = hits.pixel_begin[own.pixel]; hit < end; ++hit) {
        const std::span<const Rgb> unblocked = apart_.of(points_->of_hit[hit]).subspan(kLightKinds);
        std::ranges::transform(all, unblocked, all.begin(), std::plus());
    }
    group_seen_.assign(groups, Rgb(0));
    group_sampled_.assign(groups, Rgb(0));
    for (std::size_t i = own.begin; i < own.end; ++i) {
        const std::uint32_t group = traits_of(lights_[shadow_samples_[i].light]).group;
        group_seen_[group] += values_[i] * rays_.visible[i];
        group_sampled_[group] += values_[i];
    }
    Rgb sum(0);
    for (std::size_t group = 0; group < groups; ++group) {
        const Rgb known(glm::greaterThan(group_sampled_[group], Rgb(0)));
        const Rgb seen(quotient(group_seen_[group], group_sampled_[group]));
        group_seen_[group] = all[group] * glm::max(glm::mix(share.seen, seen, known), kLeastOfGroup * share.seen);
        sum += share.seen * all[group];
    }
    complete(group_seen_, sum, 0);
    for (std::size_t group = 0; group < groups; ++group) {
        group_seen_[group] /= glm::mix(Rgb(1), all[group], Rgb(glm::notEqual(all[group], Rgb(0))));
    }
    for (std::size_t hit = hits.pixel_begin[own.pixel]; hit < end; ++hit) {
        const std::span<const Rgb> unblocked = apart_.of(points_->of_hit[hit]);
        const std::span<Rgb> parts = hits.apart.of(hits.in_apart[hit]);
        for (std::size_t part = 0; part < parts.size(); ++part) {
            parts[part] += unblocked[part] * (part < kLightKinds ? share.seen : group_seen_[part - kLightKinds]);
        }
    }
}

}  // namespace shlight
