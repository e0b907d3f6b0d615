// SPDX-License-Identifier: MIT
//
// Light at points that surfaces have reflected. Rays go from each point into the half space about its normal, and
// radiance() says what light of surfaces they see.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "base/shading_frame.h"
#include "shlight/scene_queries.h"
#include "shlight/types.h"

namespace shlight {

/// Rays of one point. ways: unit vectors in the point's frame; radiance: the light that each brings.
using VisitBounced =
    std::function<void(std::size_t point, std::span<const Vec3d> ways, std::span<const Vec3d> radiance)>;

/// How rays are spread over a half space: their density is cosθ/π or 1/2π.
enum class Spread { by_cosine, evenly };

/// The share of the time that direct light takes where light bounces, about.
inline constexpr double kDirectShare = 0.1;

/// Calls visit once for each point, at the same time for several. settings: settings.bounce_rays rays of each point;
/// light is reflected settings.max_bounces times at most, which is at least 1. progress: from which share on it goes to
/// 1. Throws RenderCancelled where progress returns false.
void visit_bounced_light(const CompiledScene& scene, std::span<const Vec3d> points,
                         std::span<const ShadingFrame> frames, const PointSettings& settings, Spread spread,
                         const Progress& progress, double from, const VisitBounced& visit);

}  // namespace shlight
