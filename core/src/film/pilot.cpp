// SPDX-License-Identifier: MIT
#include "film/pilot.h"

#include <algorithm>
#include <cmath>

#include "film/progressive_renderer.h"
#include "shlight/sampling.h"

namespace shlight {
namespace {

/// Lights may be wrong by the tolerance times this share of the picture's mean: errors are some five times smaller than
/// the estimates by which methods are chosen, and dark points count as if they had a tenth of the mean. The mean is
/// taken from one camera ray in every kPilotStep'th pixel of a row or column, or in about kMostPilotPixels of them.
constexpr double kShareOfMean = 0.5;
constexpr int kPilotStep = 8;
constexpr int kMostPilotPixels = 16;
/// Pilot pixels per batch.
constexpr std::size_t kPilotBatch = 32;
/// Bound of the error of light that is summed up over faces ÷ the noise that is asked for. The error is smooth, and two
/// thirds of its bound under a hundred balls, a tenth under a torus.
constexpr double kFaceShare = 1;

/// Turns the bits of a coordinate that a seed names: sets that are spread evenly stay so.
double scrambled(double coordinate, std::uint32_t seed) {
    const auto bits = static_cast<std::uint32_t>(coordinate * 0x1p32);
    return (bits ^ seed) * 0x1p-32;
}

Pilot pilot_of(const Picture& picture, std::uint32_t shadow_rays, const Stopped& stopped) {
    const std::vector<Pixel> grid = spread_pixels(picture, kPilotStep, kMostPilotPixels);
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

}  // namespace

std::vector<Pixel> spread_pixels(const Picture& picture, int least_step, int most) {
    std::vector<Pixel> grid;
    const int step = std::max({least_step, picture.width / most, picture.height / most});
    for (int row = std::min(step, picture.height) / 2; row < picture.height; row += step) {
        for (int column = std::min(step, picture.width) / 2; column < picture.width; column += step) {
            grid.push_back({column, row});
        }
    }
    return grid;
}

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

void look_ahead(Picture& picture, const Stopped& stopped) {
    const auto shadow_rays = std::min(static_cast<std::uint32_t>(picture.settings.shadow_rays), kPreviewShadowRays);
    picture.lighting.face_tolerance = kFaceShare * picture.settings.sampling.noise_threshold;
    const Pilot pilot = pilot_of(picture, shadow_rays, stopped);
    picture.lighting.light_error = light_error(picture, pilot.reflected);
    picture.guide(pilot);
    if (picture.filtered) {
        picture.filtered->follow(picture.lighting);
    }
}

}  // namespace shlight
