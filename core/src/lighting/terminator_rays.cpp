// SPDX-License-Identifier: MIT
#include "lighting/terminator_rays.h"

#include <bit>
#include <cmath>
#include <cstdint>

#include "shlight/sampling.h"

namespace shlight {
namespace {

/// A number in 0 … 1 that is as good as random.
double random_of(const Vec3f& way) {
    const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
    return hash(hash(bits(way.x), bits(way.y)), bits(way.z)) * 0x1p-32;
}

}  // namespace

void TerminatorRays::lift(const Hits& hits, std::size_t hit, ShadowTarget& target, std::size_t begin, DrawnRays& rays) {
    const Terminator& own = hits.terminator[hit];
    if (!own.lifts() || !target.draws()) {
        return;
    }
    number_.clear();
    share_.clear();
    for (std::size_t ray = begin; ray < rays.size(); ++ray) {
        const double share = own.share(glm::normalize(Vec3d(rays.drawn[ray].way)));
        if (share > 0) {
            number_.push_back(ray);
            share_.push_back(share);
        }
    }
    if (number_.empty()) {
        return;
    }
    target.find_radiance(number_, rays);
    find_densities(hits, hit, rays);
    for (std::size_t i = 0; i < number_.size(); ++i) {
        const double by_light = rays.drawn[number_[i]].light_density;
        const double squares = by_light * by_light + density_[i] * density_[i];
        if (random_of(rays.drawn[number_[i]].way) * squares < by_light * by_light) {
            Ray& ray = rays.rays[number_[i]];
            const Vec3f origin = ray.origin + Vec3f(share_[i] * own.lift);
            ray.direction -= std::isinf(ray.t_max) ? Vec3f(0) : origin - ray.origin;
            ray.origin = origin;
        }
    }
}

void TerminatorRays::find_densities(const Hits& hits, std::size_t hit, const DrawnRays& rays) {
    weighed_.clear();
    for (const std::size_t ray : number_) {
        weighed_.add(ray, ray + 1, [&](std::size_t number) -> const Vec3f& { return rays.drawn[number].way; });
    }
    density_.assign(number_.size(), 0.0);
    double all = 0;
    const MaterialLobes& material = materials_[hits.material[hit]];
    for (std::size_t lobe = 0; lobe < material.lobes().size(); ++lobe) {
        const Rgb color = glm::abs(hits.weight(hit, lobe));
        if (color != Rgb(0)) {
            const LobeForm& form = hits.forms(hit)[lobe];
            const double albedo =
                double{color.x + color.y + color.z} * material.albedo(lobe, form, hits.cos_theta_o[hit]);
            weighed_.weigh(material.shape(lobe, form), hits.frame[hit], hits.view(hit), true);
            for (std::size_t i = 0; i < density_.size(); ++i) {
                density_[i] += albedo * weighed_.density(i);
            }
            all += albedo;
        }
    }
    for (double& density : density_) {
        density /= all;
    }
}

}  // namespace shlight
