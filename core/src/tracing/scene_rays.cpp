// SPDX-License-Identifier: MIT
#include "shlight/scene_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

namespace shlight {
namespace {

constexpr std::size_t kRaysAtOnce = 256;
/// Factor of the distance at which a ray goes on behind a surface, so that it does not meet it again.
constexpr float kPassedOn = 1 + 0x1p-20F;

std::shared_ptr<const RayTracer> tracer_of(std::vector<TracedInstance> instances, const Stopped& stopped) {
    const bool is_empty =
        std::ranges::none_of(instances, [](const TracedInstance& own) { return own.tree != nullptr; });
    return is_empty ? nullptr : std::make_shared<const RayTracer>(std::move(instances), stopped);
}

/// This is what bodies take of a ray's light. It may begin inside a body: the ways from its origin to where it leaves
/// bodies, less those to where it enters them, are the ways inside.
struct Absorption {
    Rgb inside{0};  // [1/m] of the bodies that the ray is in
    Rgb depth{0};   // optical

    void enter(const Rgb& body, float way) {
        inside += body;
        depth -= body * way;
    }
    /// The share of light that is left. Bodies without an end absorb nothing.
    Rgb passed(float way) const {
        const Rgb rest = std::isfinite(way) ? glm::max(inside, Rgb(0)) * way : Rgb(0);
        return glm::exp(-glm::max(depth + rest, Rgb(0)));
    }
};

}  // namespace

SceneRays::SceneRays(std::vector<TracedInstance> opaque, std::vector<TracedInstance> transparent,
                     const SurfaceTransparency& transparency, const Stopped& stopped)
    : opaque_(tracer_of(std::move(opaque), stopped)),
      transparent_(tracer_of(std::move(transparent), stopped)),
      transparency_(&transparency) {}

SceneRays::SceneRays(const SceneRays& same, const SurfaceTransparency& transparency)
    : opaque_(same.opaque_), transparent_(same.transparent_), transparency_(&transparency) {}

SceneRays::~SceneRays() = default;

void SceneRays::intersect_opaque(std::span<const Ray> rays, std::span<RayHit> hits) const {
    if (opaque_ != nullptr) {
        opaque_->intersect(rays, hits);
    } else {
        std::fill(hits.begin(), hits.end(), RayHit());
    }
}

void SceneRays::intersect(std::span<const Ray> rays, std::span<RayHit> hits) const {
    intersect_opaque(rays, hits);
    if (transparent_ == nullptr) {
        return;
    }
    std::vector<Ray> shortened(rays.begin(), rays.end());
    for (std::size_t i = 0; i < rays.size(); ++i) {
        shortened[i].t_max = hits[i].missed() ? rays[i].t_max : hits[i].distance;
    }
    std::vector<RayHit> nearer(rays.size());
    transparent_->intersect(shortened, nearer);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        hits[i] = nearer[i].missed() ? hits[i] : nearer[i];
    }
}

void SceneRays::near(const Vec3f& point, float radius, std::vector<RayHit>& found) const {
    near_opaque(point, radius, found);
    if (transparent_ != nullptr) {
        transparent_->near(point, radius, found);
    }
}

void SceneRays::near_opaque(const Vec3f& point, float radius, std::vector<RayHit>& found) const {
    if (opaque_ != nullptr) {
        opaque_->near(point, radius, found);
    }
}

void SceneRays::visibility(std::span<const Ray> rays, std::uint32_t transparent_bounces, std::span<Rgb> visible) const {
    std::array<std::uint8_t, kRaysAtOnce> blocked{};
    for (std::size_t first = 0; first < rays.size(); first += kRaysAtOnce) {
        const auto some = rays.subspan(first, std::min(kRaysAtOnce, rays.size() - first));
        if (opaque_ != nullptr) {
            opaque_->occluded(some, std::span(blocked).first(some.size()));
        }
        for (std::size_t i = 0; i < some.size(); ++i) {
            visible[first + i] = Rgb(blocked[i] == 0 ? 1 : 0);
        }
    }
    transmittance(rays, transparent_bounces, visible);
}

void SceneRays::transmittance(std::span<const Ray> rays, std::uint32_t transparent_bounces, std::span<Rgb> visible,
                              const SurfaceVisit& visit) const {
    if (transparent_ == nullptr) {
        return;
    }
    std::vector<std::size_t> active;
    std::vector<Ray> segments;
    const auto go_on = [&](std::size_t ray, Ray segment) {
        if (visible[ray] != Rgb(0)) {
            active.push_back(ray);
            segments.push_back(segment);
        }
    };
    for (std::size_t i = 0; i < rays.size(); ++i) {
        go_on(i, rays[i]);
    }
    std::vector<RayHit> hits;
    std::vector<Rgb> passed, entered;
    std::vector<Absorption> absorption;  // of each ray, or none: nothing absorbs
    for (std::uint32_t depth = 0; !active.empty(); ++depth) {
        hits.resize(active.size());
        transparent_->intersect(segments, hits);
        std::vector<std::size_t> met;
        std::vector<Ray> met_rays;
        std::vector<RayHit> met_hits;
        for (std::size_t i = 0; i < active.size(); ++i) {
            if (!hits[i].missed()) {
                met.push_back(active[i]);
                met_rays.push_back(segments[i]);
                met_hits.push_back(hits[i]);
                if (visit) visit(active[i], hits[i]);
            }
        }
        passed.assign(met.size(), Rgb(0));
        entered.assign(met.size(), Rgb(0));
        if (depth < transparent_bounces) {
            transparency_->find(met_rays, met_hits, depth, passed, entered);
        }
        active.clear();
        segments.clear();
        for (std::size_t i = 0; i < met.size(); ++i) {
            visible[met[i]] *= passed[i];
            if (entered[i] != Rgb(0)) {
                absorption.resize(rays.size());
                absorption[met[i]].enter(entered[i], met_hits[i].distance * glm::length(met_rays[i].direction));
            }
            go_on(met[i], behind(met_rays[i], met_hits[i]));
        }
    }
    for (std::size_t i = 0; i < absorption.size(); ++i) {
        visible[i] *= absorption[i].passed(rays[i].t_max * glm::length(rays[i].direction));
    }
}

Ray behind(const Ray& ray, const RayHit& hit) {
    Ray rest = ray;
    rest.t_min = std::nextafter(hit.distance * kPassedOn, INFINITY);
    return rest;
}

}  // namespace shlight
