// SPDX-License-Identifier: MIT
#include "shlight/scene_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "tracing/occluder_boxes.h"

namespace shlight {
namespace {

constexpr std::size_t kRaysAtOnce = 256;
/// Of a distance along a ray: how much farther it goes on behind a surface, so that it does not meet it again.
constexpr float kPassedOn = 1 + 0x1p-20F;

}  // namespace

/// The triangles of one kind.
class SceneRays::Part {
  public:
    static std::unique_ptr<const Part> make(std::span<const SceneGeometry> geometries,
                                            std::span<const TracedInstance> instances, bool transparent,
                                            const Stopped& stopped) {
        auto part = std::make_unique<Part>();
        std::vector<std::vector<Triangle>> chosen(geometries.size());
        std::vector<TracedGeometry> traced;
        for (std::size_t i = 0; i < geometries.size(); ++i) {
            const SceneGeometry& geometry = geometries[i];
            traced.push_back({geometry.vertices, part->choose(geometry, transparent, chosen[i])});
        }
        std::vector<TracedInstance> placed;
        for (std::uint32_t i = 0; i < instances.size(); ++i) {
            if (!traced[instances[i].geometry].triangles.empty()) {
                placed.push_back(instances[i]);
                part->instances_.push_back(i);
                part->geometry_of_.push_back(instances[i].geometry);
            }
        }
        if (placed.empty()) {
            return nullptr;
        }
        part->renumbered_ = placed.size() != instances.size() ||
                            std::any_of(part->triangles_.begin(), part->triangles_.end(),
                                        [](const std::vector<std::uint32_t>& numbers) { return !numbers.empty(); });
        part->tracer_ = std::make_unique<const RayTracer>(traced, placed, stopped);
        return part;
    }

    void intersect(std::span<const Ray> rays, std::span<RayHit> hits) const {
        tracer_->intersect(rays, hits);
        for (RayHit& hit : renumbered_ ? hits : hits.first(0)) {
            if (!hit.missed()) {
                const std::vector<std::uint32_t>& numbers = triangles_[geometry_of_[hit.instance]];
                hit.instance = instances_[hit.instance];
                hit.triangle = numbers.empty() ? hit.triangle : numbers[hit.triangle];
            }
        }
    }
    void occluded(std::span<const Ray> rays, std::span<std::uint8_t> blocked) const {
        tracer_->occluded(rays, blocked);
    }

  private:
    std::span<const Triangle> choose(const SceneGeometry& geometry, bool transparent, std::vector<Triangle>& chosen) {
        std::vector<std::uint32_t>& numbers = triangles_.emplace_back();
        if (geometry.transparent.empty()) {
            return transparent ? std::span<const Triangle>() : geometry.triangles;
        }
        for (std::uint32_t i = 0; i < geometry.triangles.size(); ++i) {
            if ((geometry.transparent[i] != 0) == transparent) {
                chosen.push_back(geometry.triangles[i]);
                numbers.push_back(i);
            }
        }
        return chosen;
    }

    std::unique_ptr<const RayTracer> tracer_;
    std::vector<std::vector<std::uint32_t>> triangles_;  // of each geometry; empty: all of them
    std::vector<std::uint32_t> instances_, geometry_of_;
    bool renumbered_ = false;  // or else all instances and triangles are those of the scene
};

SceneRays::SceneRays(std::span<const SceneGeometry> geometries, std::span<const TracedInstance> instances,
                     const SurfaceTransparency& transparency, const Stopped& stopped)
    : opaque_(Part::make(geometries, instances, false, stopped)),
      transparent_(Part::make(geometries, instances, true, stopped)),
      boxes_(std::make_shared<const OccluderBoxes>(geometries, instances)),
      transparency_(&transparency) {}

SceneRays::SceneRays(const SceneRays& same, const SurfaceTransparency& transparency)
    : opaque_(same.opaque_), transparent_(same.transparent_), boxes_(same.boxes_), transparency_(&transparency) {}

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

void SceneRays::transmittance(std::span<const Ray> rays, std::uint32_t transparent_bounces,
                              std::span<Rgb> visible) const {
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
    std::vector<Rgb> passed;
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
            }
        }
        passed.assign(met.size(), Rgb(0));
        if (depth < transparent_bounces) {
            transparency_->find(met_rays, met_hits, depth, passed);
        }
        active.clear();
        segments.clear();
        for (std::size_t i = 0; i < met.size(); ++i) {
            visible[met[i]] *= passed[i];
            go_on(met[i], behind(met_rays[i], met_hits[i]));
        }
    }
}

Ray behind(const Ray& ray, const RayHit& hit) {
    Ray rest = ray;
    rest.t_min = std::nextafter(hit.distance * kPassedOn, INFINITY);
    return rest;
}

}  // namespace shlight
