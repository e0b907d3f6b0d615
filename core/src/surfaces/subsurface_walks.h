// SPDX-License-Identifier: MIT
//
// Random walks below a surface, as long as they stay in the body that the surface bounds (Chiang, Kutz & Burley 2016,
// "Practical and Controllable Subsurface Scattering for Production Path Tracing").
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "shlight/ray_tracer.h"
#include "shlight/scene_rays.h"
#include "shlight/types.h"

namespace shlight {

/// A body's inside, which scatters light everywhere alike, with Henyey and Greenstein's phase function.
struct ScatteringMedium {
    Rgb extinction;  ///< [1/m]; 0: no light of this channel goes there
    Rgb albedo;      ///< of single scattering
    double anisotropy;
};

struct SubsurfaceWalk {
    std::size_t surface;  ///< number of the one where it begins, and of the lobe, for the caller
    std::uint32_t lobe;
    std::uint32_t instance;  ///< whose triangles alone it meets
    std::uint32_t seed;
    glm::dvec2 first;  ///< evenly spread over all walks of a pixel: for the channel and the length of the first step
    ScatteringMedium medium;
    Ray ray;         ///< its last step; the direction is unit
    Rgb throughput;  ///< share of the light at its end that reaches its beginning
    RayHit exit{};   ///< missed: light ends there
};

/// Walks on from each ray's origin, in its direction first.
void walk_below(const SceneRays& scene, std::span<SubsurfaceWalk> walks);

/// The first hit of each ray with an instance.
void intersect_instances(const SceneRays& scene, std::span<const Ray> rays, std::span<const std::uint32_t> instances,
                         std::span<RayHit> hits);

}  // namespace shlight
