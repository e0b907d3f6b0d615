// SPDX-License-Identifier: MIT
//
// What a picture took: which ways light was integrated in, how many rays, how long.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "shlight/types.h"

namespace shlight {

/// Stages of rendering: tracing camera rays; materials at their views; unshadowed light; shadow rays; and summing the
/// rays of pixels.
enum class RenderStage { camera_rays, views, light, shadows, shadow_rays, pixels };
inline constexpr std::array<const char*, 6> kRenderStages = {"camera rays", "views",       "light",
                                                             "shadows",     "shadow rays", "pixels"};

/// An instance of a mesh: Scene::MeshNumber, and its number among the mesh's instances.
using MeshInstance = std::pair<std::uint64_t, std::uint32_t>;

/// Statistics of a rendered picture.
struct RenderReport {
    // A lobe of a camera hit under a light that it sees is shaded once, by …
    std::array<std::uint64_t, kMaxOrder + 1> order_counts{};  ///< … harmonics of this order
    std::uint64_t cubature_count = 0;                         ///< … values of f·cos
    std::uint64_t mirror_count = 0;                           ///< paths into mirrors
    std::uint64_t over_tolerance = 0;                         ///< of these, where the estimate exceeds the tolerance
    std::uint64_t hits = 0;                                   ///< camera rays that met a surface
    std::uint64_t shadow_rays = 0;
    std::uint64_t records = 0;  ///< of light that bounces, which were gathered
    std::uint32_t passes = 0;   ///< over the picture or some of its pixels, that have ended
    /// Root mean square over the pixels of the estimated errors, see PixelSampling::noise_threshold; 0
    /// while most pixels have no rays that are kept.
    double noise = 0;
    double seconds = 0;
    double seconds_left = 0;  ///< that are probably left; 0 while nothing is known of them
    std::array<double, kRenderStages.size()> stage_seconds{};  ///< by RenderStage, summed over threads

    /// Instances with faces that lie on others where the camera sees them: rays that begin there in float may meet
    /// these. Ascending; empty until the picture is whole.
    std::vector<MeshInstance> doubled{};

    /// Adds what is a sum over parts of the work.
    RenderReport& operator+=(const RenderReport& part);
};

}  // namespace shlight
