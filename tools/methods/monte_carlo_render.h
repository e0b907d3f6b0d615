// SPDX-License-Identifier: MIT
//
// Pictures by plain Monte Carlo, as a renderer without analytic lighting makes them, for comparison.
//
// Each sample of a pixel is a camera ray through a random point of its square. Where it meets a surface, every light
// gets a direction uniform in its solid angle, and one direction as the material reflects serves all lights; both are
// weighed by the balance heuristic (Veach & Guibas 1995) and followed by shadow rays. Unbiased.
#pragma once

#include <cstdint>
#include <span>

#include "shlight/camera.h"
#include "shlight/parallel.h"
#include "shlight/scene.h"

namespace shlight::methods {

struct MonteCarloSettings {
    int samples = 64;  ///< camera rays per pixel
    std::uint32_t seed = 0;
    int threads = 0;  ///< 0: all cores
};

/// Throws std::invalid_argument naming the member or argument: samples outside 1 … 2^20, and as check_render does.
void check_monte_carlo(const MonteCarloSettings& settings, int width, int height);

/// image: as of shlight::render, to whose limit the mean over seeds is equal. It depends on nothing but scene, camera,
/// size, samples and seed. Throws as check_monte_carlo does, also for an image of another size;
/// RenderCancelled when progress returns false; what progress throws.
void render_monte_carlo(const CompiledScene& scene, const Camera& camera, int width, int height,
                        const MonteCarloSettings& settings, std::span<float> image, const Progress& progress = {});

}  // namespace shlight::methods
