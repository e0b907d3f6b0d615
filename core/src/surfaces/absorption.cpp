// SPDX-License-Identifier: MIT
//
// What bodies absorb along the paths of CameraSurfaces.
#include <algorithm>

#include <glm/exponential.hpp>

#include "surfaces/camera_surfaces.h"

namespace shlight {
namespace {

/// Surfaces along a ray, at most, of which is found where it begins.
constexpr int kMostSurfaces = 256;

Rgb absorption_of(const Material& material) {
    return material.shader != nullptr ? material.shader->absorption : Rgb(0);
}

}  // namespace

void CameraSurfaces::absorb(Surface& end, double length) const {
    const Rgb own = absorption_of(scene_->materials()[end.point.material]);
    if (own != Rgb(0) && scene_->placed().is_back(end.hit, end.towards_viewer)) {
        // A path whose beginning is inside has not entered what it leaves.
        end.absorption = glm::max(end.absorption, own);
        end.absorption_beyond = end.absorption - own;
    } else {
        end.absorption_beyond = end.absorption + own;
    }
    if (end.absorption != Rgb(0)) {
        end.throughput *= glm::exp(-end.absorption * static_cast<float>(length));
    }
}

bool CameraSurfaces::has_absorbing(std::span<const Material> materials) {
    return std::ranges::any_of(materials, [](const Material& own) { return absorption_of(own) != Rgb(0); });
}

/// Returns that of the bodies which the ray leaves more often than it enters them.
Rgb CameraSurfaces::absorption_at(const Ray& ray) const {
    Rgb sum(0);
    if (!has_bodies_) {
        return sum;
    }
    const std::span<const Material> materials = scene_->materials();
    Ray rest = ray;
    rest.kinds = kAllRays;
    const Vec3d towards_viewer = -glm::normalize(Vec3d(ray.direction));
    for (int layer = 0; layer < kMostSurfaces; ++layer) {
        RayHit hit;
        scene_->rays().intersect({&rest, 1}, {&hit, 1});
        if (hit.missed()) {
            break;
        }
        const Rgb own = absorption_of(materials[scene_->placed().surface(hit, ray.direction).material]);
        sum += scene_->placed().is_back(hit, towards_viewer) ? own : -own;
        rest = behind(rest, hit);
    }
    return glm::max(sum, Rgb(0));
}

}  // namespace shlight
