// SPDX-License-Identifier: MIT
#include "shlight/render.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/checks.h"
#include "film/pixel_batch.h"
#include "film/progressive_renderer.h"
#include "film/refinement.h"
#include "shlight/sampling.h"

namespace shlight {
namespace {

constexpr std::int64_t kMostPixels = 1 << 28;

/// Rays of a pixel: each takes up to 160 bytes in each of the 256 pixels that a thread shades at once.
constexpr std::int64_t kMostShadowRays = 1 << 14;

constexpr double kLeastFilter = 0.001;
constexpr double kWidestFilter = 100;

/// Lights may be wrong by the tolerance times this share of the picture's mean: errors are some five times smaller than
/// the estimates by which methods are chosen, and dark points count as if they had a tenth of the mean. The mean is
/// taken from one camera ray in every kPilotStep'th pixel of a row or column, or in about kMostPilotPixels of them.
constexpr double kShareOfMean = 0.5;
constexpr int kPilotStep = 8;
constexpr int kMostPilotPixels = 16;
/// Pilot pixels per batch.
constexpr std::size_t kPilotBatch = 32;
/// Error of light that is summed up over faces ÷ the noise that is asked for: it is smooth, and smaller than that.
constexpr double kFaceShare = 0.5;

/// Turns the bits of a coordinate that a seed names: sets that are spread evenly stay so.
double scrambled(double coordinate, std::uint32_t seed) {
    const auto bits = static_cast<std::uint32_t>(coordinate * 0x1p32);
    return (bits ^ seed) * 0x1p-32;
}

/// The same for every level but that of the preview, or the most even ones where there is one level.
std::vector<glm::dvec2> pixel_points(const Refinement& refinement, std::uint32_t seed) {
    const std::uint32_t most = refinement.samples(refinement.most_level());
    std::vector<glm::dvec2> points = refinement.most_level() > 0 ? nested_points(most) : hammersley(most);
    for (glm::dvec2& point : seed != 0 ? std::span(points) : std::span<glm::dvec2>()) {
        point = {scrambled(point.x, hash(seed, 0)), scrambled(point.y, hash(seed, 1))};
    }
    if (refinement.has_preview()) {
        points.insert(points.begin(), glm::dvec2(0.5));
    }
    return points;
}

Pilot pilot_of(const Picture& picture, std::uint32_t shadow_rays, const Stopped& stopped) {
    std::vector<Pixel> grid;
    const int step = std::max({kPilotStep, picture.width / kMostPilotPixels, picture.height / kMostPilotPixels});
    for (int row = std::min(step, picture.height) / 2; row < picture.height; row += step) {
        for (int column = std::min(step, picture.width) / 2; column < picture.width; column += step) {
            grid.push_back({column, row});
        }
    }
    std::vector<Pilot> sums((grid.size() + kPilotBatch - 1) / kPilotBatch);
    const auto add_up = [&](std::size_t i) {
        end_if(stopped);
        const std::size_t first = i * kPilotBatch;
        const std::size_t size = std::min(kPilotBatch, grid.size() - first);
        sums[i] = PixelBatch(picture, picture.paths(nullptr)).pilot(std::span(grid).subspan(first, size), shadow_rays);
    };
    parallel_for(sums.size(), picture.settings.threads, add_up);
    Pilot all;
    for (const Pilot& part : sums) {
        all.reflected += part.reflected / static_cast<double>(grid.size());
        all.hidden += part.hidden;
        all.seen += part.seen;
    }
    return all;
}

/// How wrong a pixel may be by one light. The errors of many lights have no common sign, so that those of n add up to
/// √n of them.
double light_error(const Picture& picture, double mean) {
    const double count = static_cast<double>(std::max<std::size_t>(picture.lighting.extended.size(), 1));
    return picture.settings.tolerance * kShareOfMean * mean / std::sqrt(count);
}

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
    check_range("threads", settings.threads, 0, std::numeric_limits<int>::max());
    const PassLayout layout(settings.passes);
}

RenderReport render(const CompiledScene& scene, const Camera& camera, int width, int height,
                    const RenderSettings& settings, std::span<float> image, const RenderWatch& watch,
                    std::span<float> passes) {
    check_render(settings, width, height);
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    check_size("image", image.size(), 4 * pixels);
    check_size("passes", passes.size(), PassLayout(settings.passes).stride() * pixels);
    const auto start = ProgressiveRenderer::Clock::now();
    std::optional<Picture> picture;
    std::optional<ProgressiveRenderer> renderer;
    std::atomic<bool> is_prepared = false;
    const auto work = [&](const Watch& caller) {
        Refinement refinement(width, height, settings.sampling, camera.has_depth_of_field());
        picture.emplace(scene, camera, width, height, settings, pixel_points(refinement, settings.seed),
                        refinement.has_preview() ? 1 : 0, caller.stopped);
        const auto shadow_rays = std::min(static_cast<std::uint32_t>(settings.shadow_rays), kLeastShadowRays);
        picture->lighting.face_tolerance = kFaceShare * settings.sampling.noise_threshold;
        const Pilot pilot = pilot_of(*picture, shadow_rays, caller.stopped);
        picture->lighting.light_error = light_error(*picture, pilot.reflected);
        picture->guide(pilot);
        std::fill(image.begin(), image.end(), 0.0F);
        std::fill(passes.begin(), passes.end(), 0.0F);
        renderer.emplace(*picture, std::move(refinement), image, passes, watch, start);
        is_prepared = true;
        renderer->run(caller);
    };
    const auto look = [&] { return is_prepared ? renderer->look() : !watch.progress || watch.progress(0); };
    const bool is_watched = watch.progress || watch.on_update;
    run_watched(settings.threads, work, is_watched ? std::function<bool()>(look) : std::function<bool()>());
    if (watch.progress && !watch.progress(1.0)) {
        throw RenderCancelled();
    }
    return renderer->report();
}

}  // namespace shlight
