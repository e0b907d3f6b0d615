// SPDX-License-Identifier: MIT
#include "shlight/scene_queries.h"

#include <limits>
#include <string>
#include <vector>

#include "base/scene_range.h"
#include "base/unit_direction.h"
#include "queries/query_points.h"
#include "surfaces/placed_meshes.h"

namespace shlight {
namespace {

void check(const char* position, std::span<const Vec3d> positions, const char* direction,
           std::span<const Vec3d> directions) {
    check_size(direction, directions.size(), positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
        check_position(position, positions[i]);
        unit_direction(directions[i], direction);
    }
}

}  // namespace

void check_rays(std::span<const Vec3d> origins, std::span<const Vec3d> directions) {
    check("origins", origins, "directions", directions);
}

void check_points(std::span<const Vec3d> points, std::span<const Vec3d> normals) {
    check("points", points, "normals", normals);
}

void check_settings(const PointSettings& settings) {
    constexpr int kMostRays = 1 << 14;
    const auto check = [](const char* name, int value, int least, int most) {
        if (value < least || value > most) {
            reject(std::string(name) + " must be " + std::to_string(least) + " … " + std::to_string(most) + ", got " +
                   std::to_string(value));
        }
    };
    check("rays", settings.rays, 0, kMostRays);
    check("transparent_bounces", settings.transparent_bounces, 0, kMostBounces);
    check("max_bounces", settings.max_bounces, 0, kMostBounces);
    check("bounce_rays", settings.bounce_rays, 2, kMostRays);
    check("threads", settings.threads, 0, std::numeric_limits<int>::max());
}

void intersect(const CompiledScene& scene, std::span<const Vec3d> origins, std::span<const Vec3d> directions,
               std::span<SurfaceHit> hits) {
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < origins.size(); ++i) {
        rays.push_back(query_ray(scene, origins[i], directions[i]));
    }
    std::vector<RayHit> met(rays.size());
    scene.rays().intersect(rays, met);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        hits[i] = {};
        if (!met[i].missed()) {
            const PlacedMeshes& placed = scene.placed();
            const SurfacePoint point = placed.surface(met[i], rays[i].direction);
            const Vec3d position = point.position + scene.origin();
            const Vec3d uv = placed.uv(met[i]);
            const Placement& placement = placed.placements()[met[i].instance];
            hits[i] = {glm::distance(position, origins[i]),
                       position,
                       point.geometric_normal,
                       point.shading_normal,
                       {uv.x, uv.y},
                       static_cast<std::int64_t>(scene.mesh_numbers()[placement.mesh]),
                       placement.number,
                       met[i].triangle};
        }
    }
}

}  // namespace shlight
