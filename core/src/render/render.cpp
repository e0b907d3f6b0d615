// SPDX-License-Identifier: MIT
#include "shlight/render.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "base/checks.h"
#include "render/pixel_batch.h"
#include "render/refinement.h"
#include "shlight/sampling.h"

namespace shlight {
namespace {

constexpr int kMostPixelSamples = 1 << 20;
constexpr std::int64_t kMostRaysPerPixel = 1 << 22;
constexpr std::int64_t kMostPixels = 1 << 28;

/// Edge of the tiles of the first pass.
constexpr int kLargestTile = 32;

/// Edge of the blocks of pixels of later passes.
constexpr int kBlock = 4;

/// An adaptive pixel has up to 4^kMostLevel times the rays of the first pass. Each round can follow something
/// thin by one pixel more.
constexpr int kMostLevel = 2;
constexpr int kMostRounds = 8;
/// Of each camera ray that is added, where the settings allow as many. With fewer the ratio of a glossy lobe, whose
/// peak may then be among none of them, is far too large where the peak is hidden.
constexpr std::uint32_t kLeastShadowRays = 8;

/// Lights may be wrong by the tolerance times this share of the picture's mean: errors are some five times smaller than
/// the estimates by which methods are chosen, and dark points count as if they had a tenth of the mean. The mean is
/// taken from one camera ray in every kPilotStep'th pixel of a row or column, or in about kMostPilotPixels of them.
constexpr double kShareOfMean = 0.5;
constexpr int kPilotStep = 8;
constexpr int kMostPilotPixels = 16;

/// The share of progress that is left to all later passes.
constexpr double kLaterShare = 0.4;

int tile_edge(std::uint32_t pixel_samples, std::uint32_t batch_samples) {
    int edge = kLargestTile;
    while (edge > 1 && std::int64_t{edge} * edge * pixel_samples > batch_samples) {
        edge /= 2;
    }
    return edge;
}

struct Tile {
    int left, top, right, bottom;  // pixels; right and bottom excluded
};

std::vector<Tile> tiles_of(int width, int height, int edge) {
    std::vector<Tile> tiles;
    for (int top = 0; top < height; top += edge) {
        for (int left = 0; left < width; left += edge) {
            tiles.push_back({left, top, std::min(left + edge, width), std::min(top + edge, height)});
        }
    }
    return tiles;
}

std::vector<Pixel> pixels_of(const Tile& tile) {
    std::vector<Pixel> pixels;
    for (int row = tile.top; row < tile.bottom; ++row) {
        for (int column = tile.left; column < tile.right; ++column) {
            pixels.push_back({column, row});
        }
    }
    return pixels;
}

/// In blocks, so that those which are rendered together see what lies together.
std::vector<Pixel> close_together(std::span<const Pixel> pixels) {
    std::vector<Pixel> sorted(pixels.begin(), pixels.end());
    const auto block = [](const Pixel& p) { return std::pair(p.row / kBlock, p.column / kBlock); };
    std::stable_sort(sorted.begin(), sorted.end(), [&](const Pixel& a, const Pixel& b) { return block(a) < block(b); });
    return sorted;
}

bool is_adaptive(const RenderSettings& settings) {
    return settings.adaptive && settings.pixel_samples > 1;
}

std::uint32_t base_samples(const RenderSettings& settings) {
    const auto samples = static_cast<std::uint32_t>(settings.pixel_samples);
    return is_adaptive(settings) ? std::bit_ceil(samples) : samples;
}

int most_level(const RenderSettings& settings) {
    int level = is_adaptive(settings) ? kMostLevel : 0;
    while (level > 0 && std::int64_t{base_samples(settings)} << (2 * level) > kMostPixelSamples) {
        --level;
    }
    return level;
}

std::vector<glm::dvec2> pixel_points(const RenderSettings& settings) {
    const std::uint32_t base = base_samples(settings);
    return is_adaptive(settings) ? nested_points(base << (2 * most_level(settings))) : hammersley(base);
}

/// How wrong a pixel may be by one light. The errors of many lights have no common sign, so that those of n add up to
/// √n of them.
double light_error(const Picture& picture, std::uint32_t shadow_rays) {
    std::vector<Pixel> grid;
    const int step = std::max({kPilotStep, picture.width / kMostPilotPixels, picture.height / kMostPilotPixels});
    for (int row = std::min(step, picture.height) / 2; row < picture.height; row += step) {
        for (int column = std::min(step, picture.width) / 2; column < picture.width; column += step) {
            grid.push_back({column, row});
        }
    }
    const double sum = kShareOfMean * PixelBatch(picture).reflected(grid, shadow_rays);
    const double count = static_cast<double>(std::max<std::size_t>(picture.lights.size(), 1));
    return picture.settings.tolerance * sum / std::sqrt(count);
}

/// One render: the first pass over all pixels, and passes over fewer of them.
class Passes {
  public:
    Passes(const Picture& picture, std::span<float> image, const Progress& progress)
        : picture_(&picture),
          image_(image),
          progress_(progress),
          batch_samples_(picture.batch_samples()),
          refinement_(picture.width, picture.height, base_samples(picture.settings), most_level(picture.settings)),
          batches_([&picture] { return PixelBatch(picture); }) {}

    void run();
    RenderReport report();

  private:
    void first_pass();
    void refine(const RefinementGroup& group);
    void render(std::span<const Pixel> pixels, int from, int to);
    void run_parallel(std::size_t count, double share_after, const std::function<void(std::size_t)>& body);

    const Picture* picture_;
    std::span<float> image_;
    const Progress& progress_;
    std::uint32_t batch_samples_;
    double share_ = 0;  // of the work, as reported
    Refinement refinement_;
    tbb::enumerable_thread_specific<PixelBatch> batches_;
};

void Passes::run() {
    first_pass();
    if (is_adaptive(picture_->settings)) {
        refinement_.set_mean(image_);
        for (int round = 0; round < kMostRounds; ++round) {
            const auto groups = refinement_.next_round(image_);
            if (groups.empty()) break;
            for (const RefinementGroup& group : groups) {
                refine(group);
            }
        }
    }
    if (progress_ && !progress_(1.0)) {
        throw RenderCancelled();
    }
}

void Passes::run_parallel(std::size_t count, double share_after, const std::function<void(std::size_t)>& body) {
    const Progress progress = [&](double share) { return progress_(share_ + share * (share_after - share_)); };
    parallel_for(count, picture_->settings.threads, body, progress_ ? progress : Progress());
    share_ = share_after;
}

void Passes::first_pass() {
    const auto tiles = tiles_of(picture_->width, picture_->height, tile_edge(refinement_.samples(0), batch_samples_));
    run_parallel(tiles.size(), is_adaptive(picture_->settings) ? 1 - kLaterShare : 1.0,
                 [&](std::size_t i) { render(pixels_of(tiles[i]), -1, 0); });
}

void Passes::refine(const RefinementGroup& group) {
    const std::size_t rays = refinement_.samples(group.to) - refinement_.samples(group.from);
    const std::size_t count = batch_samples_ / std::clamp<std::size_t>(rays, 1, batch_samples_);
    const std::vector<Pixel> pixels = close_together(group.pixels);
    // How many passes are left is not known.
    run_parallel((pixels.size() + count - 1) / count, (1 + share_) / 2, [&](std::size_t i) {
        render(std::span(pixels).subspan(i * count, std::min(count, pixels.size() - i * count)), group.from, group.to);
    });
}

void Passes::render(std::span<const Pixel> pixels, int from, int to) {
    const auto most_shadow_rays = static_cast<std::uint32_t>(picture_->settings.shadow_rays);
    // A pixel's many rays share the work of resolving its penumbrae.
    const std::uint32_t shadow_rays =
        std::max(std::min(most_shadow_rays, kLeastShadowRays), most_shadow_rays >> (2 * to));
    const std::uint32_t most = std::max<std::uint32_t>(
        refinement_.samples(0), std::min<std::uint32_t>(batch_samples_, kMostRaysPerPixel / std::max(shadow_rays, 1U)));
    std::vector<PixelSums> sums(pixels.size());
    for (std::uint32_t first = refinement_.samples(from); first < refinement_.samples(to);) {
        const std::uint32_t count = std::min(most, refinement_.samples(to) - first);
        batches_.local().add(pixels, {first, count, shadow_rays}, sums);
        first += count;
    }
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        refinement_.merge(pixels[i], to, sums[i], image_);
    }
}

void add(RenderReport& sum, const RenderReport& part) {
    std::transform(sum.order_counts.begin(), sum.order_counts.end(), part.order_counts.begin(),
                   sum.order_counts.begin(), std::plus<>());
    sum.cubature_count += part.cubature_count;
    sum.mirror_count += part.mirror_count;
    sum.summed_count += part.summed_count;
    sum.hits += part.hits;
    sum.over_tolerance += part.over_tolerance;
    sum.shadow_rays += part.shadow_rays;
    std::transform(sum.stage_seconds.begin(), sum.stage_seconds.end(), part.stage_seconds.begin(),
                   sum.stage_seconds.begin(), std::plus<>());
}

RenderReport Passes::report() {
    RenderReport report;
    for (const PixelBatch& batch : batches_) {
        add(report, batch.report());
    }
    return report;
}

void check_range(const char* name, std::int64_t value, std::int64_t least, std::int64_t most) {
    if (value < least || value > most) {
        reject(std::string(name) + " must be " + std::to_string(least) + " … " + std::to_string(most) + ", got " +
               std::to_string(value));
    }
}

}  // namespace

void check_render(const RenderSettings& settings, int width, int height) {
    check_range("width", width, 1, kMostPixels);
    check_range("height", height, 1, kMostPixels / width);
    check_range("order", settings.order, 0, kMaxOrder);
    if (!(std::isfinite(settings.tolerance) && settings.tolerance > 0)) {
        reject("tolerance must be positive and finite");
    }
    check_range("pixel_samples", settings.pixel_samples, 1, kMostPixelSamples);
    check_range("shadow_rays", settings.shadow_rays, 0,
                std::min<std::int64_t>(kMostPixelSamples, kMostRaysPerPixel / settings.pixel_samples));
    check_range("transparent_bounces", settings.transparent_bounces, 0, 1024);
    check_range("threads", settings.threads, 0, std::numeric_limits<int>::max());
}

RenderReport render(const CompiledScene& scene, const Camera& camera, int width, int height,
                    const RenderSettings& settings, std::span<float> image, const Progress& progress) {
    check_render(settings, width, height);
    check_size("image", image.size(), 4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    const auto start = std::chrono::steady_clock::now();
    Picture picture(scene, camera, width, height, settings, pixel_points(settings));
    picture.light_error =
        light_error(picture, std::min(static_cast<std::uint32_t>(settings.shadow_rays), kLeastShadowRays));
    Passes passes(picture, image, progress);
    passes.run();
    RenderReport report = passes.report();
    report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return report;
}

}  // namespace shlight
