// SPDX-License-Identifier: MIT
//
// What rays through a scene meet and see, and the light at points of it, without a picture. Vectors are in the world's
// frame, in metres; of the spans of a call, the i-th elements belong together.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

#include "shlight/parallel.h"
#include "shlight/render.h"
#include "shlight/scene.h"
#include "shlight/types.h"

namespace shlight {

// Functions that take a Progress call it from any of their threads, at times from several at once; it may throw.
// RenderCancelled comes where it returns false.

/// Throw std::invalid_argument naming the argument where a number is outside docs/conventions.md's range, or a
/// direction or normal has length 0. All functions below take vectors that pass, directions and normals of any length.
void check_rays(std::span<const Vec3d> origins, std::span<const Vec3d> directions);
void check_points(std::span<const Vec3d> points, std::span<const Vec3d> normals);

/// The first surface that a ray meets, opaque or not.
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

/// The radiance that each ray sees, as a camera ray of render() does; black where it meets nothing and the camera does
/// not see the environment. Each ray is a pixel through which settings.sampling.min_samples … max_samples rays go the
/// same way, until the estimated error of their mean, relative to √(r² + 0.01 r̄²), r the mean and r̄ that of all rays,
/// is not above the noise threshold. Light that bounces comes by paths, without records. Textures are read where a ray
/// meets them, without a footprint. The result does not depend on settings.threads. sees_lights: false: light counts
/// only if a surface has reflected it, not what rays meet themselves of emission, lamps and the environment. settings:
/// passes, the filter and the time limit do not matter. Throws as check_render does.
void radiance(const CompiledScene& scene, std::span<const Vec3d> origins, std::span<const Vec3d> directions,
              const RenderSettings& settings, bool sees_lights, std::span<Vec3d> radiance,
              const Progress& progress = {});

/// How the light at points is found.
struct PointSettings {
    /// Shadow rays of a point for each light, 0 … 2^14; 0: no shadows.
    int rays = 64;
    /// Surfaces that let light through which a shadow ray passes, at most 1024.
    int transparent_bounces = 8;
    /// Surfaces that light is reflected by before it comes to a point, 0 … 1024; 0: direct light.
    int max_bounces = 0;
    /// Rays of a point by which it finds reflected light, 2 … 2^14.
    int bounce_rays = 256;
    int threads = 0;         ///< 0: all cores; the result does not depend on it
    std::uint32_t seed = 0;  ///< another one draws other rays
};

/// Throws std::invalid_argument naming the member that is out of range, as all functions below do.
void check_settings(const PointSettings& settings);

/// Irradiance [W m⁻²] on a surface at each point, from the side of its normal, as a diffuse surface
/// there gets it: without lights that do not light such. A light takes rays by its share of the irradiance, at most
/// twice settings.rays, and one where rays from points nearby agree about it. errors: standard deviations by shadow
/// and other rays, as many, or none. Those of shadow rays are estimated as if the edge of one shadow crossed each
/// light, over which points are spread evenly: √v n^-3/4 for n rays of variance v; those of rays for reflected light as
/// if they were independent.
void irradiance(const CompiledScene& scene, std::span<const Vec3d> points, std::span<const Vec3d> normals,
                const PointSettings& settings, std::span<Vec3d> irradiance, std::span<Vec3d> errors,
                const Progress& progress = {});

/// Coefficients of the radiance that comes to each point, in its frame and clipped by its horizon (Eq. 4 of Zhou & Wei
/// 2020). frames: of each point the axes x, y and z, the normal, as columns: orthonormal and right-handed.
/// coefficients: points × order² × RGB. Without shadows they are exact for lights of even radiance: spheres, polygons,
/// disks, suns, convex meshes, sources without extent, and an environment of one radiance. Others are summed over 4096
/// points. With shadows they are an estimate without bias, and without noise where all rays agree. errors: their
/// standard deviations, as many, or none. Those by shadows are told by two halves of the rays, each by itself roughly;
/// those of the 4096 points are left out.
void light_coefficients(const CompiledScene& scene, std::span<const Vec3d> points, std::span<const glm::dmat3> frames,
                        int order, const PointSettings& settings, std::span<double> coefficients,
                        std::span<double> errors = {}, const Progress& progress = {});

}  // namespace shlight
