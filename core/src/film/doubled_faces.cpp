// SPDX-License-Identifier: MIT
#include "film/doubled_faces.h"

#include <algorithm>
#include <cstddef>
#include <optional>

#include "film/pilot.h"
#include "shlight/scene_rays.h"
#include "surfaces/doubled_faces.h"
#include "surfaces/placed_meshes.h"

namespace shlight {
namespace {

/// Pixels of a row or column that are looked at.
constexpr int kMostPixelsOfRow = 64;

}  // namespace

std::vector<bool> find_doubled(const Picture& picture, const Stopped& stopped) {
    const SceneRays& rays = picture.scene->rays();
    const PlacedMeshes& placed = picture.scene->placed();
    std::vector<Ray> seen;
    for (const Pixel& pixel : spread_pixels(picture, 1, kMostPixelsOfRow)) {
        seen.push_back(picture.ray(pixel.column + 0.5, pixel.row + 0.5, std::nullopt));
        seen.back().kinds = kCameraRay;
    }
    std::vector<RayHit> hits(seen.size());
    rays.intersect(seen, hits);
    std::vector<bool> found;
    std::vector<RayHit> near;
    for (std::size_t i = 0; i < hits.size(); ++i) {
        end_if(stopped);
        const RayHit& hit = hits[i];
        if (hit.missed()) {
            continue;
        }
        const SurfacePoint point = placed.surface(hit, seen[i].direction);
        near.clear();
        rays.near(Vec3f(point.position), static_cast<float>(2 * point.error), near);
        for (const RayHit& other : near) {
            if (covers(placed, other, hit, point)) {
                found.resize(placed.placements().size());
                found[hit.instance] = found[other.instance] = true;
            }
        }
    }
    return found;
}

std::vector<MeshInstance> instances_of(const CompiledScene& scene, const std::vector<bool>& placements) {
    std::vector<MeshInstance> instances;
    for (std::size_t i = 0; i < placements.size(); ++i) {
        if (placements[i]) {
            const Placement& own = scene.placed().placements()[i];
            instances.emplace_back(scene.mesh_numbers()[own.mesh], own.number);
        }
    }
    std::ranges::sort(instances);
    return instances;
}

}  // namespace shlight
