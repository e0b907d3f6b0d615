// SPDX-License-Identifier: MIT
#include "shlight/render.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include <tbb/enumerable_thread_specific.h>

#include "checks.h"
#include "hits.h"
#include "material_orders.h"
#include "shading_points.h"
#include "shlight/sampling.h"
#include "unshadowed.h"
#include "visibility.h"

namespace shlight {
namespace {

constexpr int kMostSamples = 1 << 20;
constexpr std::int64_t kMostRaysPerPixel = 1 << 22;
constexpr std::int64_t kMostPixels = 1 << 28;

/// Camera rays that a tile holds at a time, and its largest edge: enough for long batches, few enough for the cache.
constexpr std::int64_t kTileSamples = 4096;
constexpr int kLargestTile = 32;

/// Lights whose unshadowed values are held at a time.
constexpr std::size_t kLightBlock = 8;

int tile_edge(int pixel_samples) {
    int edge = kLargestTile;
    while (edge > 1 && std::int64_t{edge} * edge * pixel_samples > kTileSamples) {
        edge /= 2;
    }
    return edge;
}

struct Tile {
    int left, top, right, bottom;  // pixels; right and bottom excluded
};

/// Everything that the tiles of one picture share and only read.
struct Picture {
    const CompiledScene* scene;
    const Camera* camera;
    RenderSettings settings;
    int width, height;
    Window window;
    std::vector<glm::dvec2> pixel_points;
    std::vector<OrderedMaterial> materials;
    std::size_t lobe_stride = 1;

    Picture(const CompiledScene& s, const Camera& c, int w, int h, const RenderSettings& r)
        : scene(&s),
          camera(&c),
          settings(r),
          width(w),
          height(h),
          window(c.window(w, h)),
          pixel_points(hammersley(static_cast<std::uint32_t>(r.pixel_samples))) {
        for (const Material& material : s.materials()) {
            materials.emplace_back(material.bsdf, r);
            lobe_stride = std::max(lobe_stride, materials.back().lobes().size());
        }
    }
};

/// Renders one tile after another; one per thread.
class TileRenderer {
  public:
    explicit TileRenderer(const Picture& picture)
        : picture_(&picture),
          unshadowed_(picture.lobe_stride),
          shadowed_(picture.scene->rays(), picture.settings, picture.materials, picture.lobe_stride) {}

    void render(const Tile& tile, std::span<float> image) {
        trace_camera_rays(tile);
        points_.assign(hits_, picture_->materials, picture_->lobe_stride, picture_->scene->lights(),
                       picture_->settings.tolerance, report_);
        unshadowed_.group(points_);
        add_lights(tile);
        write_pixels(tile, image);
    }

    RenderReport report() const {
        RenderReport report = report_;
        report.shadow_rays = shadowed_.rays_traced();
        return report;
    }

  private:
    void trace_camera_rays(const Tile& tile);
    void add_lights(const Tile& tile);
    void write_pixels(const Tile& tile, std::span<float> image) const;

    const Picture* picture_;
    RenderReport report_;
    std::vector<Ray> rays_;
    std::vector<RayHit> ray_hits_;
    Hits hits_;
    ShadingPoints points_;
    Unshadowed unshadowed_;
    ShadowedLight shadowed_;
    std::vector<std::uint32_t> pixel_seeds_;
};

void TileRenderer::trace_camera_rays(const Tile& tile) {
    const Picture& p = *picture_;
    const auto samples = static_cast<std::uint32_t>(p.settings.pixel_samples);
    rays_.clear();
    for (int row = tile.top; row < tile.bottom; ++row) {
        for (int column = tile.left; column < tile.right; ++column) {
            for (std::uint32_t sample = 0; sample < samples; ++sample) {
                const double x = (column + p.pixel_points[sample].x) / p.width;
                const double y = (row + p.pixel_points[sample].y) / p.height;
                rays_.push_back(p.camera->ray(p.window.left + x * (p.window.right - p.window.left),
                                              p.window.top + y * (p.window.bottom - p.window.top)));
            }
        }
    }
    ray_hits_.resize(rays_.size());
    p.scene->rays().intersect(rays_, ray_hits_);
    hits_.clear();
    for (std::size_t first = 0; first < rays_.size(); first += samples) {
        for (std::uint32_t sample = 0; sample < samples; ++sample) {
            const RayHit& hit = ray_hits_[first + sample];
            if (!hit.missed()) {
                const Vec3f& direction = rays_[first + sample].direction;
                const SurfacePoint surface = p.scene->surface(hit, direction);
                hits_.add(surface, -glm::normalize(Vec3d(direction)), p.scene->materials()[surface.material].emission,
                          sample);
            }
        }
        hits_.end_pixel();
    }
    report_.hits += hits_.size();
}

void TileRenderer::add_lights(const Tile& tile) {
    const auto lights = picture_->scene->lights();
    for (std::size_t first = 0; first < lights.size(); first += kLightBlock) {
        const auto block = lights.subspan(first, std::min(kLightBlock, lights.size() - first));
        unshadowed_.compute(points_, picture_->materials, block);
        for (std::size_t i = 0; i < block.size(); ++i) {
            pixel_seeds_.clear();
            for (int row = tile.top; row < tile.bottom; ++row) {
                for (int column = tile.left; column < tile.right; ++column) {
                    const std::uint32_t pixel =
                        hash(static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(row));
                    pixel_seeds_.push_back(hash(pixel, static_cast<std::uint32_t>(first + i)));
                }
            }
            shadowed_.add(block[i], unshadowed_.light(i), points_.of_hit, pixel_seeds_, hits_);
        }
    }
}

void TileRenderer::write_pixels(const Tile& tile, std::span<float> image) const {
    const auto samples = static_cast<float>(picture_->settings.pixel_samples);
    std::size_t pixel = 0;
    for (int row = tile.top; row < tile.bottom; ++row) {
        for (int column = tile.left; column < tile.right; ++column, ++pixel) {
            Vec3d sum(0);
            for (std::size_t hit = hits_.pixel_begin[pixel]; hit < hits_.pixel_begin[pixel + 1]; ++hit) {
                sum += Vec3d(hits_.radiance[hit]);
            }
            const auto count = static_cast<float>(hits_.pixel_begin[pixel + 1] - hits_.pixel_begin[pixel]);
            const Rgb color(sum / static_cast<double>(samples));
            const std::size_t offset = 4 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(picture_->width) +
                                            static_cast<std::size_t>(column));
            image[offset] = color.x;
            image[offset + 1] = color.y;
            image[offset + 2] = color.z;
            image[offset + 3] = count / samples;
        }
    }
}

std::vector<Tile> tiles_of(int width, int height, int edge) {
    std::vector<Tile> tiles;
    for (int top = 0; top < height; top += edge) {
        for (int left = 0; left < width; left += edge) {
            tiles.push_back({left, top, std::min(left + edge, width), std::min(top + edge, height)});
        }
    }
    return tiles;
}

void add(RenderReport& sum, const RenderReport& part) {
    std::transform(sum.order_counts.begin(), sum.order_counts.end(), part.order_counts.begin(),
                   sum.order_counts.begin(), std::plus<>());
    sum.hits += part.hits;
    sum.over_tolerance += part.over_tolerance;
    sum.shadow_rays += part.shadow_rays;
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
    check_range("pixel_samples", settings.pixel_samples, 1, kMostSamples);
    check_range("shadow_rays", settings.shadow_rays, 0,
                std::min<std::int64_t>(kMostSamples, kMostRaysPerPixel / settings.pixel_samples));
    check_range("threads", settings.threads, 0, std::numeric_limits<int>::max());
}

RenderReport render(const CompiledScene& scene, const Camera& camera, int width, int height,
                    const RenderSettings& settings, std::span<float> image, const Progress& progress) {
    check_render(settings, width, height);
    check_size("image", image.size(), 4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    const auto start = std::chrono::steady_clock::now();
    const Picture picture(scene, camera, width, height, settings);
    const std::vector<Tile> tiles = tiles_of(width, height, tile_edge(settings.pixel_samples));
    tbb::enumerable_thread_specific<TileRenderer> renderers([&] { return TileRenderer(picture); });
    parallel_for(
        tiles.size(), settings.threads, [&](std::size_t i) { renderers.local().render(tiles[i], image); }, progress);
    RenderReport report;
    for (const TileRenderer& renderer : renderers) {
        add(report, renderer.report());
    }
    report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return report;
}

}  // namespace shlight
