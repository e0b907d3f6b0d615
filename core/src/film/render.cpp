// SPDX-License-Identifier: MIT
#include "shlight/render.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/checks.h"
#include "film/doubled_faces.h"
#include "film/light_loan.h"
#include "film/pilot.h"
#include "film/pixel_batch.h"
#include "film/progressive_renderer.h"
#include "film/refinement.h"

namespace shlight {
namespace {

constexpr std::int64_t kMostPixels = 1 << 28;

/// Rays of a pixel: each takes up to 160 bytes in each of the 256 pixels that a thread shades at once.
constexpr std::int64_t kMostShadowRays = 1 << 14;

constexpr double kLeastFilter = 0.001;
constexpr double kWidestFilter = 100;
constexpr double kMostFilter = 100;

void check_range(const char* name, std::int64_t value, std::int64_t least, std::int64_t most) {
    if (value < least || value > most) {
        reject(std::string(name) + " must be " + std::to_string(least) + " … " + std::to_string(most) + ", got " +
               std::to_string(value));
    }
}

}  // namespace

PixelSampling PixelSampling::refined(int samples) {
    constexpr int kTimes = 16;
    const bool can_grow = samples > 1 && samples <= kMostPixelSamples / kTimes;
    const int most = can_grow ? kTimes * static_cast<int>(std::bit_ceil(static_cast<unsigned>(samples))) : samples;
    return {.first_samples = samples, .min_samples = samples, .max_samples = most};
}

double least_width_after_diffuse(double filter_glossy) {
    // √(1 - kc)/2 times the density 2c of c = cosθ, integrated up to where the root ends, by u = 1 - kc.
    const double k = 1 / (std::numbers::pi * filter_glossy);
    const double end = std::max(1 - k, 0.0);
    return (2 * (1 - std::pow(end, 1.5)) / 3 - 2 * (1 - std::pow(end, 2.5)) / 5) / (k * k);
}

void check_render(const RenderSettings& settings, int width, int height) {
    check_range("width", width, 1, kMostPixels);
    check_range("height", height, 1, kMostPixels / width);
    check_range("order", settings.order, 0, kMaxOrder);
    if (!(std::isfinite(settings.tolerance) && settings.tolerance > 0)) {
        reject("tolerance must be positive and finite");
    }
    const PixelSampling& sampling = settings.sampling;
    check_range("max_samples", sampling.max_samples, 1, kMostPixelSamples);
    check_range("min_samples", sampling.min_samples, 1, sampling.max_samples);
    check_range("first_samples", sampling.first_samples, 1, sampling.max_samples);
    if (!(sampling.noise_threshold >= 0 && sampling.noise_threshold <= 1)) {
        reject("noise_threshold must be 0 … 1");
    }
    if (!std::isfinite(sampling.time_limit)) {
        reject("time_limit must be finite");
    }
    if (!(settings.filter.width >= kLeastFilter && settings.filter.width <= kWidestFilter)) {
        reject("filter_width must be 0.001 … 100");
    }
    check_range("shadow_rays", settings.shadow_rays, 0,
                std::min<std::int64_t>(kMostShadowRays, kMostRaysPerPixel / sampling.first_samples));
    check_range("transparent_bounces", settings.transparent_bounces, 0, kMostBounces);
    check_range("max_bounces", settings.max_bounces, 0, kMostBounces);
    check_range("glossy_bounces", settings.glossy_bounces, 0, kMostBounces);
    check_range("transmission_bounces", settings.transmission_bounces, 0, kMostBounces);
    if (!(settings.filter_glossy >= 0 && settings.filter_glossy <= kMostFilter)) {
        reject("filter_glossy must be 0 … 100");
    }
    if (!(settings.clamp_indirect >= 0 && std::isfinite(settings.clamp_indirect))) {
        reject("clamp_indirect must be 0 or more, and finite");
    }
    check_range("threads", settings.threads, 0, std::numeric_limits<int>::max());
    const PassLayout layout(settings.passes);
}

RenderReport render(const CompiledScene& scene, const Camera& camera, int width, int height,
                    const RenderSettings& settings, std::span<float> image, const RenderWatch& watch,
                    std::span<float> passes, KeptLight* kept) {
    check_render(settings, width, height);
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    check_size("image", image.size(), 4 * pixels);
    check_size("passes", passes.size(), PassLayout(settings.passes).stride() * pixels);
    const auto start = ProgressiveRenderer::Clock::now();
    std::optional<Picture> picture;
    std::optional<LightLoan> light;
    std::optional<ProgressiveRenderer> renderer;
    std::atomic<bool> is_prepared = false;
    const auto work = [&](const Watch& caller) {
        Refinement refinement(width, height, settings.sampling, camera.has_depth_of_field());
        picture.emplace(scene, camera, width, height, settings, pixel_points(refinement, settings.seed),
                        refinement.has_preview() ? 1 : 0, caller.stopped);
        look_ahead(*picture, caller.stopped);
        picture->doubled = find_doubled(*picture, caller.stopped);
        light.emplace(kept, *picture);
        std::fill(image.begin(), image.end(), 0.0F);
        std::fill(passes.begin(), passes.end(), 0.0F);
        renderer.emplace(*picture, std::move(refinement), light->light(), image, passes, watch, start);
        is_prepared = true;
        renderer->run(caller);
    };
    const auto look = [&] { return is_prepared ? renderer->look() : !watch.progress || watch.progress(0); };
    const bool is_watched = watch.progress || watch.on_update;
    run_watched(settings.threads, work, is_watched ? std::function<bool()>(look) : std::function<bool()>());
    if (watch.progress && !watch.progress(1.0)) {
        throw RenderCancelled();
    }
    RenderReport report = renderer->report();
    report.doubled = instances_of(scene, picture->doubled);
    return report;
}

}  // namespace shlight
