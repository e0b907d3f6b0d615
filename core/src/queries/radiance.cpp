// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "base/checks.h"
#include "lighting/direct_lighting.h"
#include "lighting/ray_sums.h"
#include "queries/query_points.h"
#include "queries/query_progress.h"
#include "shlight/sampling.h"
#include "shlight/scene_queries.h"
#include "surfaces/camera_surfaces.h"

namespace shlight {
namespace {

/// Rays that are shaded together, at most.
constexpr std::uint32_t kRadianceBatch = 512;
/// Rays of a pixel whose paths are drawn, at least: fewer do not tell how they differ.
constexpr std::uint32_t kLeastPaths = 4;
/// Largest radiance of a ray; squares of brighter ones would overflow in float.
constexpr double kBrightestRay = 1e18;

/// What is known of the rays that go the same way.
struct Seen {
    Vec3d radiance{0};  ///< its sum
    Vec3d squares{0};   ///< of the radiance of each, without the noise
    Vec3d noise{0};     ///< the variance of `radiance` by shadow rays
};

/// The mean over the channels of the squared error of the mean of so many rays ÷ the square of what it is relative to.
double relative_square(const Seen& seen, double count, double least_square) {
    const Vec3d mean = seen.radiance / count;
    const Vec3d by_paths = count > 1 ? glm::max(seen.squares / count - mean * mean, Vec3d(0)) / (count - 1) : Vec3d(0);
    const Vec3d share = quotient(by_paths + seen.noise / (count * count), mean * mean + least_square);
    return (share.x + share.y + share.z) / 3;
}

PathSettings paths_of(const RenderSettings& settings) {
    return {static_cast<std::uint32_t>(settings.transparent_bounces), static_cast<std::uint32_t>(settings.max_bounces),
            static_cast<std::uint32_t>(settings.glossy_bounces),
            static_cast<std::uint32_t>(settings.transmission_bounces)};
}

/// One per thread.
struct RayShader {
    RayShader(const CompiledScene& scene, const LightingScene& lights, const PathSettings& paths)
        : surfaces(scene, lights.materials, paths),
          lighting(lights, scene.rays(), paths.transparent_bounces, kWholeLight),
          hits(lights.lobe_stride) {}

    CameraSurfaces surfaces;
    DirectLighting lighting;
    Hits hits;
    std::vector<CameraRay> rays;
    std::vector<RayLight> light;
    std::vector<std::uint32_t> seeds, penumbrae;
    RenderReport report;
};

class RadianceQuery {
  public:
    RadianceQuery(const CompiledScene& scene, std::span<const Vec3d> origins, std::span<const Vec3d> directions,
                  const RenderSettings& settings, bool sees_lights, const Progress& progress)
        : scene_(&scene),
          origins_(origins),
          directions_(directions),
          settings_(&settings),
          sees_lights_(sees_lights),
          progress_(progress),
          lighting_(scene,
                    lobes_of_materials(scene.materials(), settings.order, settings.tolerance, progress_.stopped()),
                    settings.order, settings.tolerance),
          seen_(origins.size()),
          shaders_([this] { return RayShader(*scene_, lighting_, paths()); }) {}

    void run(std::span<Vec3d> radiance);

  private:
    /// A ray that sees no lights is one that a surface has scattered.
    PathSettings paths() const {
        PathSettings paths = paths_of(*settings_);
        paths.max_bounces += sees_lights_ ? 0 : 1;
        return paths;
    }
    /// Numbers by which CameraSurfaces tells a ray's light apart.
    std::size_t counts() const { return sees_lights_ ? 1 : paths().max_bounces; }
    void shade(std::span<const std::uint32_t> pixels, std::uint32_t first, std::uint32_t count, RayShader& shader);
    void add_up(std::span<const std::uint32_t> pixels, std::uint32_t first, std::uint32_t count,
                const RayShader& shader);
    void erase_good(std::vector<std::uint32_t>& pixels, double count) const;

    const CompiledScene* scene_;
    std::span<const Vec3d> origins_, directions_;
    const RenderSettings* settings_;
    bool sees_lights_;
    QueryProgress progress_;
    LightingScene lighting_;
    std::vector<Seen> seen_;
    double least_square_ = 0;
    tbb::enumerable_thread_specific<RayShader> shaders_;
};

void RadianceQuery::run(std::span<Vec3d> radiance) {
    std::vector<std::uint32_t> pixels(origins_.size());
    std::iota(pixels.begin(), pixels.end(), 0U);
    const std::uint32_t at_once = std::min(kRadianceBatch, lighting_.batch_size());
    const PixelSampling& sampling = settings_->sampling;
    const auto most = static_cast<std::uint32_t>(sampling.max_samples);
    const std::uint32_t least = settings_->max_bounces > 0 ? kLeastPaths : 1;
    std::uint32_t count = std::clamp(static_cast<std::uint32_t>(sampling.min_samples), std::min(least, most), most);
    progress_.start(pixels.size() * most);
    for (std::uint32_t first = 0; !pixels.empty() && first < most;) {
        const std::size_t size = std::max(at_once / count, 1U);
        parallel_for((pixels.size() + size - 1) / size, settings_->threads, [&](std::size_t batch) {
            const auto some = std::span(pixels).subspan(batch * size, std::min(size, pixels.size() - batch * size));
            for (std::uint32_t done = 0; done < count; done += at_once) {
                shade(some, first + done, std::min(count - done, at_once), shaders_.local());
                progress_.add(some.size() * std::min(count - done, at_once));
            }
        });
        for (const std::uint32_t pixel : pixels) {
            radiance[pixel] = seen_[pixel].radiance / static_cast<double>(first + count);
        }
        if (first == 0) {
            const Vec3d sum = std::accumulate(radiance.begin(), radiance.end(), Vec3d(0));
            const double mean = (sum.x + sum.y + sum.z) / (3.0 * static_cast<double>(radiance.size()));
            least_square_ = 0.01 * mean * mean;
        }
        first += count;
        const std::size_t followed = pixels.size();
        erase_good(pixels, first);
        progress_.add((followed - pixels.size()) * (most - first));
        count = std::min(first, most - first);
    }
}

void RadianceQuery::erase_good(std::vector<std::uint32_t>& pixels, double count) const {
    const double threshold = settings_->sampling.noise_threshold;
    std::erase_if(pixels, [&](std::uint32_t pixel) {
        return threshold > 0 && relative_square(seen_[pixel], count, least_square_) <= threshold * threshold;
    });
}

void RadianceQuery::shade(std::span<const std::uint32_t> pixels, std::uint32_t first, std::uint32_t count,
                          RayShader& shader) {
    shader.rays.clear();
    shader.seeds.clear();
    for (const std::uint32_t pixel : pixels) {
        shader.seeds.push_back(hash(pixel, settings_->seed));
        const Ray ray = query_ray(*scene_, origins_[pixel], directions_[pixel]);
        for (std::uint32_t i = 0; i < count; ++i) {
            shader.rays.push_back({ray, first + i, shader.seeds.back()});
        }
    }
    if (sees_lights_) {
        shader.surfaces.trace(shader.rays, {}, count, shader.hits, shader.light);
    } else {
        shader.surfaces.trace_scattered(shader.rays, {}, count, shader.hits, shader.light);
    }
    const auto shadow_rays = static_cast<std::uint32_t>(settings_->shadow_rays);
    shader.penumbrae.assign(pixels.size(), LightBits::kAll);
    shader.lighting.add(shader.seeds, shader.penumbrae, {first, count, shadow_rays, first * shadow_rays}, shader.hits,
                        shader.report);
    add_up(pixels, first, count, shader);
}

void RadianceQuery::add_up(std::span<const std::uint32_t> pixels, std::uint32_t first, std::uint32_t count,
                           const RayShader& shader) {
    const Hits& hits = shader.hits;
    std::vector<Vec3d> radiance(count);
    for (std::size_t p = 0; p < pixels.size(); ++p) {
        Seen& seen = seen_[pixels[p]];
        std::fill(radiance.begin(), radiance.end(), Vec3d(0));
        for (std::size_t i = 0; i < count * counts(); ++i) {
            radiance[i / counts()] += Vec3d(shader.light[p * count * counts() + i].radiance);
        }
        Vec3d noise(0);
        for (std::size_t hit = hits.pixel_begin[p]; hit < hits.pixel_begin[p + 1]; ++hit) {
            radiance[hits.sample[hit] - first] += Vec3d(hits.radiance[hit]);
            noise += Vec3d(hits.noise[hit]);
        }
        seen.squares -= noise;
        seen.noise += noise + Vec3d(hits.shared_noise[p]);
        for (const Vec3d& own : radiance) {
            const Vec3d shown = glm::clamp(own, -kBrightestRay, kBrightestRay);
            seen.radiance += shown;
            seen.squares += shown * shown;
        }
    }
}

}  // namespace

void radiance(const CompiledScene& scene, std::span<const Vec3d> origins, std::span<const Vec3d> directions,
              const RenderSettings& settings, bool sees_lights, std::span<Vec3d> radiance, const Progress& progress) {
    check_render(settings, 1, 1);
    check_size("radiance", radiance.size(), origins.size());
    RadianceQuery(scene, origins, directions, settings, sees_lights, progress).run(radiance);
}

}  // namespace shlight
