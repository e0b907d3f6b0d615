// SPDX-License-Identifier: MIT
#include "lighting/shadow_rays.h"

#include <algorithm>
#include <array>

namespace shlight {
namespace {

/// A diffuse lobe has so many times fewer rays of its own than the guided light has.
constexpr std::uint32_t kGuidedRays = 4;

}  // namespace

ShadowRays::ShadowRays(ShadowTracer& tracer, std::span<const MaterialLobes> materials, std::size_t lobe_stride)
    : tracer_(&tracer), lobe_stride_(lobe_stride), lobes_(materials), points_(0), terminator_(materials) {
    for (const MaterialLobes& material : materials) {
        Material& sets = materials_.emplace_back();
        for (const Lobe& lobe : material.lobes()) {
            const auto alike = [&](std::size_t other) { return spread_alike(material.lobes()[other], lobe); };
            const auto known = std::find_if(sets.lobes.begin(), sets.lobes.end(), alike);
            sets.set_of_lobe.push_back(static_cast<std::size_t>(known - sets.lobes.begin()));
            if (known == sets.lobes.end()) {
                sets.lobes.push_back(sets.set_of_lobe.size() - 1);
            }
        }
        set_stride_ = std::max(set_stride_, sets.lobes.size());
    }
    points_ = PixelPoints(1 + set_stride_);
}

void ShadowRays::start(ShadowTarget& target, const Hits& hits, const LitHits& lit) {
    target_ = &target;
    hits_ = &hits;
    lit_ = &lit;
    rays_.clear();
    runs_.assign(lit.hit.size(), {});
    set_share_.assign(lit.hit.size() * set_stride_, 0);
}

void ShadowRays::draw(const LitRange& pixel, const SampleRange& samples, std::uint32_t seed) {
    points_.start(samples, hits_->sample[lit_->hit[pixel.begin]], hits_->sample[lit_->hit[pixel.end - 1]], seed);
    for (std::size_t i = pixel.begin; i < pixel.end; ++i) {
        target_->aim(*hits_, lit_->hit[i], i, i == pixel.begin);
        draw_hit(i, samples.shadow_rays);
    }
}

void ShadowRays::trace(bool shadows) {
    if (shadows) {
        target_->trace(*tracer_, rays_);
    } else {
        rays_.visible.assign(rays_.size(), Rgb(1));
    }
    for (std::size_t i = 0; i < lit_->hit.size(); ++i) {
        const std::size_t hit = lit_->hit[i];
        for (std::size_t ray = runs_[i].begin; hits_->terminator[hit].dims() && ray < runs_[i].end; ++ray) {
            rays_.visible[ray] *= static_cast<float>(hits_->let_in(hit, Vec3d(rays_.drawn[ray].way)));
        }
    }
}

bool ShadowRays::shines(std::size_t lit_index, const Material& material, std::size_t set) const {
    for (std::size_t lobe = 0; lobe < material.set_of_lobe.size(); ++lobe) {
        if (material.set_of_lobe[lobe] == set && lit_->shines[lit_index * lobe_stride_ + lobe] != 0) {
            return true;
        }
    }
    return false;
}

LobeShape ShadowRays::set_shape(std::size_t hit, std::size_t set) const {
    const std::uint32_t material = hits_->material[hit];
    const std::size_t lobe = materials_[material].lobes[set];
    return sampled_shape(lobes_[material].shape(lobe, hits_->forms(hit)[lobe]));
}

void ShadowRays::draw_hit(std::size_t lit_index, std::uint32_t rays) {
    const std::size_t hit = lit_->hit[lit_index];
    const Material& material = materials_[hits_->material[hit]];
    runs_[lit_index].begin = rays_.size();
    runs_[lit_index].guided = target_->is_guided();
    if (target_->draws() || target_->is_guided()) {
        const PixelPoints::Square square = points_.of(0, hits_->sample[hit], rays);
        target_->draw(square.u, square.v, rays, rays_);
    }
    for (std::size_t set = 0; set < material.lobes.size(); ++set) {
        const LobeShape shape = set_shape(hit, set);
        if (shines(lit_index, material, set) && target_->may_meet(shape, hits_->view(hit))) {
            const std::uint32_t own =
                target_->is_guided() && !is_glossy(shape) ? std::max(rays / kGuidedRays, 1U) : rays;
            set_share(lit_index, set) = static_cast<float>(own) / static_cast<float>(rays);
            draw_set(lit_index, set, shape, own);
        }
    }
    terminator_.lift(*hits_, hit, *target_, runs_[lit_index].begin, rays_);
    runs_[lit_index].end = rays_.size();
}

void ShadowRays::draw_set(std::size_t lit_index, std::size_t set, const LobeShape& shape, std::uint32_t rays) {
    const std::size_t hit = lit_->hit[lit_index];
    const PixelPoints::Square square = points_.of(1 + set, hits_->sample[hit], rays);
    alignas(64) std::array<float, kRaysAtOnce> x, y, z;  // all are written before they are read
    const RayVectors directions = {x.data(), y.data(), z.data()};
    for (std::uint32_t first = 0; first < rays; first += kRaysAtOnce) {
        const std::uint32_t count = std::min(rays - first, kRaysAtOnce);
        sample_lobe_rays(shape, hits_->view(hit), square.u + first, square.v + first, count, directions);
        target_->meet(directions, count, is_glossy(shape) ? kGlossyRay : kDiffuseRay, rays_);
    }
}

LightBits ShadowRays::visibility(const LitRange& pixel, std::size_t light) const {
    LightBits bits;
    for (std::size_t ray = runs_[pixel.begin].begin; ray < runs_[pixel.end - 1].end; ++ray) {
        bits.add(light, rays_.visible[ray]);
    }
    return bits;
}

bool ShadowRays::is_guided(const LitRange& pixel) const {
    const auto first = runs_.begin() + static_cast<std::ptrdiff_t>(pixel.begin);
    return std::any_of(first, first + static_cast<std::ptrdiff_t>(pixel.size()),
                       [](const Run& run) { return run.guided; });
}

void ShadowRays::gather(std::size_t lit_index) {
    weighed_.clear();
    weighed_.add(runs_[lit_index].begin, runs_[lit_index].end,
                 [&](std::size_t ray) -> const Vec3f& { return rays_.drawn[ray].way; });
}

void ShadowRays::weigh(std::span<const LitRange> pixels) {
    lobe_density_.assign(rays_.size(), 0.0F);
    wanted_.clear();
    for (const LitRange& pixel : pixels) {
        for (std::size_t i = pixel.begin; i < pixel.end; ++i) {
            for (std::size_t ray = runs_[i].begin; ray < runs_[i].end; ++ray) {
                wanted_.push_back(ray);
            }
            add_densities(i);
        }
    }
    target_->find_radiance(wanted_, rays_);
    target_->guide(wanted_, rays_);
}

void ShadowRays::add_densities(std::size_t lit_index) {
    const std::size_t hit = lit_->hit[lit_index];
    bool gathered = false;
    for (std::size_t set = 0; set < materials_[hits_->material[hit]].lobes.size(); ++set) {
        const float share = set_share(lit_index, set);
        if (share == 0) {
            continue;
        }
        if (!gathered) {
            gather(lit_index);
            gathered = true;
        }
        weighed_.weigh(set_shape(hit, set), hits_->frame[hit], hits_->view(hit), true);
        for (std::size_t i = 0; i < weighed_.size(); ++i) {
            const std::size_t ray = weighed_.number(i);
            lobe_density_[ray] += share * weighed_.density(i);
        }
    }
}

ShadowRays::Sums ShadowRays::sum(std::size_t lit_index, std::size_t lobe, bool split) {
    const std::size_t hit = lit_->hit[lit_index];
    const LobeShape shape = lobes_[hits_->material[hit]].shape(lobe, hits_->forms(hit)[lobe]);
    gather(lit_index);
    weighed_.weigh(shape, hits_->frame[hit], hits_->view(hit), false);
    const bool is_grey = rays_.color.empty() && tracer_->is_opaque() && !hits_->terminator[hit].dims();
    GreySums grey;
    Sums sums = {{}, {}, weighed_.size(), runs_[lit_index].guided && !is_glossy(shape)};
    for (std::size_t i = 0; i < weighed_.size(); ++i) {
        const std::size_t ray = weighed_.number(i);
        const DrawnRay& drawn = rays_.drawn[ray];
        const Rgb& visible = rays_.visible[ray];
        // A ray at the edge of what can be drawn may have no density in float.
        const float density = drawn.light_density + lobe_density_[ray];
        const double value{density > 0 ? weighed_.value(i) * drawn.radiance / density : 0.0F};
        if (is_grey) {
            grey.add(value, visible.x > 0);
        } else if (rays_.color.empty()) {
            sums.smooth.add(Vec3d(value), visible);
        } else if (split) {
            sums.smooth.add(value * Vec3d(rays_.color[ray]), visible);
            sums.spots.add(value * Vec3d(rays_.spot_color[ray]), visible);
        } else {
            const Rgb spots = rays_.spot_color.empty() ? Rgb(0) : rays_.spot_color[ray];
            sums.smooth.add(value * Vec3d(rays_.color[ray] + spots), visible);
        }
    }
    if (is_grey) {
        sums.smooth = RaySums(grey);
    }
    sums.smooth *= Vec3d(target_->strength());
    return sums;
}

}  // namespace shlight
