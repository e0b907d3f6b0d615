// SPDX-License-Identifier: MIT
//
// What rays through a scene meet and see, and the light at points of it, without a picture. Vectors are in the world's
// frame, in metres; of the spans of a call, the i-th elements belong together.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include <glm/vec2.hpp>

#include "shlight/parallel.h"
#include "shlight/render.h"
#include "shlight/scene.h"
#include "shlight/types.h"

namespace shlight {

/// Throw std::invalid_argument naming the argument where a number is outside docs/conventions.md's range, or a
/// direction or normal has length 0. All functions below take vectors that pass, directions and normals of any length.
void check_rays(std::span<const Vec3d> origins, std::span<const Vec3d> directions);
void check_points(std::span<const Vec3d> points, std::span<const Vec3d> normals);

/// Where a ray meets its first surface, opaque or not.
struct SurfaceHit {
    double distance = std::numeric_limits<double>::infinity();  ///< from the ray's origin [m]; infinite: there is none
    Vec3d position{0};                                          ///< in the triangle's plane
    Vec3d normal{0}, shading_normal{0};                         ///< unit, turned to the ray's origin
    glm::dvec2 uv{0};                                           ///< the value of Pass::uv
    std::int64_t mesh = -1;                                     ///< Scene::MeshNumber
    std::int64_t instance = -1, triangle = -1;                  ///< of the mesh
};

void intersect(const CompiledScene& scene, std::span<const Vec3d> origins, std::span<const Vec3d> directions,
               std::span<SurfaceHit> hits);

/// What each ray sees, as a camera ray of render() does; black where it meets nothing and the camera does not see the
/// environment. Each ray is a pixel through which settings.sampling.min_samples … max_samples rays go the same way,
/// until the estimated error of their mean, relative to √(r² + 0.01 r̄²), r the mean and r̄ that of all rays, is not
/// above the noise threshold. Light that bounces comes by paths, without records. Textures are read where a ray meets
/// them, without a footprint. The result does not depend on settings.threads. sees_lights: false: light counts only if
/// a surface has reflected it, not what rays meet themselves of emission, lamps and the environment. settings: passes,
/// the filter and the time limit do not matter. Throws as check_render does; RenderCancelled once stopped, and what
/// `stopped` throws.
void radiance(const CompiledScene& scene, std::span<const Vec3d> origins, std::span<const Vec3d> directions,
              const RenderSettings& settings, bool sees_lights, std::span<Vec3d> radiance, const Stopped& stopped = {});

}  // namespace shlight
