// SPDX-License-Identifier: MIT
//
// Pictures: direct light from area lights by Eq. 5 of Zhou & Wei 2020, times a visibility ratio from shadow rays.
#pragma once

#include <span>

#include "shlight/camera.h"
#include "shlight/parallel.h"
#include "shlight/render_report.h"
#include "shlight/scene.h"
#include "shlight/types.h"

namespace shlight {

struct RenderSettings {
    int order = 0;  ///< 1 … 64: harmonics of this order for every light; 0: the cheapest that meets the tolerance
    /// Error of the light that a point reflects to the camera ÷ that light, or ÷ a tenth of the picture's mean where
    /// that is larger. Only for order 0.
    double tolerance = kDefaultTolerance;
    int pixel_samples = 16;  ///< camera rays per pixel, spread evenly over its square; see adaptive
    /// Per camera ray and light, at most, and again for each roughness of the glossy lobes; 0: no shadows.
    int shadow_rays = 16;
    int threads = 0;  ///< 0: all cores
    /// pixel_samples are the least that a pixel gets: they are rounded up to a power of two, and 4 or 16 times as many
    /// are spread over a pixel, up to 2^20, where they disagree so much that its mean may be wrong by more than some 1
    /// %, or where a neighbour saw something that may have been missed. One ray per pixel cannot disagree and stays
    /// one.
    bool adaptive = true;
    /// Surfaces that a shadow ray passes through as far as they are transparent, at most; a camera ray passes one more.
    int transparent_bounces = 8;
};

/// Throws std::invalid_argument naming the member or argument: order outside 0 … 64, tolerance ≤ 0 or not finite,
/// pixel_samples outside 1 … 2^20, shadow_rays outside 0 … 2^20, more than 2^22 of both per pixel, transparent_bounces
/// outside 0 … 1024, threads < 0, width or height < 1, or more than 2^28 pixels.
void check_render(const RenderSettings& settings, int width, int height);

/// image: height × width × RGBA, row 0 on top, linear, premultiplied, the mean of all camera rays of each pixel; alpha
/// is the share of them that met a surface or, where the camera sees it, the environment. The picture depends on
/// nothing but scene, camera, size and settings; not on the number of threads. Throws as check_render does, also for an
/// image of another size; RenderCancelled when progress returns false; what progress throws.
RenderReport render(const CompiledScene& scene, const Camera& camera, int width, int height,
                    const RenderSettings& settings, std::span<float> image, const Progress& progress = {});

}  // namespace shlight
