// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "base/checks.h"
#include "base/ray_rounding.h"
#include "base/unit_direction.h"
#include "lighting/direct_lighting.h"
#include "queries/bounced_light.h"
#include "queries/point_cells.h"
#include "queries/query_points.h"
#include "queries/query_progress.h"
#include "shlight/sampling.h"
#include "shlight/scene_queries.h"

namespace shlight {
namespace {

/// Error of the light without shadows ÷ that light.
constexpr double kTolerance = 1e-4;
/// Points that are shaded together, at most.
constexpr std::size_t kIrradianceBatch = 256;
/// Points of a cell of space, about. Some of them ask first what is in the way of each light.
constexpr std::size_t kCellPoints = 16;
constexpr std::size_t kAskFirst = 4;
constexpr std::uint32_t kFirstRays = 16;
/// The least number of points that are near each other.
constexpr std::size_t kLeastDense = 1024;
constexpr std::uint32_t kFirstSeed = 0xFFFFFFFDU;
/// SampleRange::shadow_rays ÷ those that are asked for: a light that has an eighth of the brightness then gets as
/// many, see ShadowBudget::rays().
constexpr std::uint32_t kTimesShare = 2;
/// Lights that LightBits tell apart.
constexpr std::size_t kLightBits = 32;

/// One per thread.
struct PointShader {
    PointShader(const CompiledScene& scene, const LightingScene& lights, std::uint32_t transparent_bounces)
        : points(scene), lighting(lights, scene.rays(), transparent_bounces, kWholeLight) {}

    QueryPoints points;
    DirectLighting lighting;
    std::vector<Vec3d> positions;
    std::vector<ShadingFrame> frames;
    std::vector<std::uint32_t> seeds, penumbrae;
    RenderReport report;
};

class IrradianceQuery {
  public:
    IrradianceQuery(const CompiledScene& scene, std::span<const Vec3d> points, std::span<const Vec3d> normals,
                    const PointSettings& settings, QueryProgress& progress)
        : points_(points),
          normals_(normals),
          settings_(&settings),
          progress_(&progress),
          lighting_(scene, {MaterialLobes(Bsdf::lambert(Rgb(1)).lobes(), 0, kTolerance)}, 0, kTolerance),
          cells_(points, kCellPoints),
          penumbrae_(cells_.size(), LightBits::kAll),
          shaders_([&scene, this] {
              return PointShader(scene, lighting_, static_cast<std::uint32_t>(settings_->transparent_bounces));
          }) {}

    void run(std::span<Vec3d> irradiance, std::span<Vec3d> errors);

  private:
    /// Finds which lights are partly hidden from the points of a cell and those around it.
    void ask_first();
    /// Shades the points first, first + step … up to `last` in the order of cells_; visit(i, hits, number of the hit)
    /// for each.
    template <class Visit>
    void shade(std::size_t first, std::size_t last, std::size_t step, const SampleRange& samples, std::uint32_t seed,
               const Visit& visit);

    std::span<const Vec3d> points_, normals_;
    const PointSettings* settings_;
    QueryProgress* progress_;
    LightingScene lighting_;
    PointCells cells_;
    std::vector<std::uint32_t> penumbrae_;  // of each cell, as in LightBits
    tbb::enumerable_thread_specific<PointShader> shaders_;
};

template <class Visit>
void IrradianceQuery::shade(std::size_t first, std::size_t last, std::size_t step, const SampleRange& samples,
                            std::uint32_t seed, const Visit& visit) {
    progress_->add(0);
    PointShader& shader = shaders_.local();
    shader.positions.clear();
    shader.frames.clear();
    shader.seeds.clear();
    shader.penumbrae.clear();
    for (std::size_t i = first; i < last; i += step) {
        const std::uint32_t point = cells_.order()[i];
        const Vec3d normal = unit_direction(normals_[point]);
        shader.positions.push_back(points_[point]);
        shader.frames.push_back(shading_frame(points_[point], normal, normal));
        shader.seeds.push_back(hash(hash(point, settings_->seed), seed));
        shader.penumbrae.push_back(penumbrae_[cells_.cell(i)]);
    }
    shader.points.set(shader.positions, shader.frames);
    shader.lighting.add(shader.seeds, shader.penumbrae, samples, shader.points.hits(), shader.report);
    for (std::size_t i = first; i < last; i += step) {
        visit(i, shader.points.hits(), (i - first) / step);
    }
}

void IrradianceQuery::ask_first() {
    std::vector<LightBits> of_point(points_.size());
    const std::size_t size = kAskFirst * kIrradianceBatch;
    parallel_for((points_.size() + size - 1) / size, settings_->threads, [&](std::size_t batch) {
        const std::size_t last = std::min((batch + 1) * size, points_.size());
        shade(batch * size, last, kAskFirst, {0, 1, kFirstRays, 0}, kFirstSeed,
              [&](std::size_t i, const Hits& hits, std::size_t hit) { of_point[i] = hits.visibility[hit]; });
    });
    std::vector<LightBits> of_cell(cells_.size());
    for (std::size_t i = 0; i < points_.size(); i += kAskFirst) {
        of_cell[cells_.cell(i)] |= of_point[i];
    }
    for (std::size_t cell = 0; cell < cells_.size(); ++cell) {
        LightBits near;
        cells_.for_each_near(cell, [&](std::size_t other) { near |= of_cell[other]; });
        penumbrae_[cell] = near.partly_hidden();
    }
}

void IrradianceQuery::run(std::span<Vec3d> irradiance, std::span<Vec3d> errors) {
    const bool asks = points_.size() >= kLeastDense && settings_->rays > 1 && lighting_.extended.size() < kLightBits;
    if (asks) {
        ask_first();
    }
    const std::uint32_t rays = kTimesShare * static_cast<std::uint32_t>(settings_->rays);
    const double evenness = 1 / std::sqrt(std::max(settings_->rays, 1));
    const std::size_t size = std::min<std::size_t>(kIrradianceBatch, lighting_.batch_size());
    progress_->start(points_.size());
    parallel_for((points_.size() + size - 1) / size, settings_->threads, [&](std::size_t batch) {
        const std::size_t last = std::min((batch + 1) * size, points_.size());
        shade(batch * size, last, 1, {0, 1, rays, 0, !asks}, 0, [&](std::size_t i, const Hits& hits, std::size_t hit) {
            // The lobe of the hits reflects the π-th part.
            irradiance[cells_.order()[i]] = std::numbers::pi * Vec3d(hits.radiance[hit]);
            if (!errors.empty()) {
                const Vec3d variance = evenness * Vec3d(hits.noise[hit]) + Vec3d(hits.shared_noise[hit]);
                errors[cells_.order()[i]] = std::numbers::pi * glm::sqrt(variance);
            }
        });
        progress_->add(last - batch * size);
    });
}

/// Adds the light that surfaces reflect to the points.
void add_bounced(const CompiledScene& scene, std::span<const Vec3d> points, std::span<const Vec3d> normals,
                 const PointSettings& settings, const Progress& progress, std::span<Vec3d> irradiance,
                 std::span<Vec3d> errors) {
    std::vector<ShadingFrame> frames;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3d normal = unit_direction(normals[i]);
        frames.push_back(shading_frame(points[i], normal, normal));
    }
    const auto visit = [&](std::size_t point, std::span<const Vec3d> /*ways*/, std::span<const Vec3d> radiance) {
        const auto count = static_cast<double>(radiance.size());
        Vec3d mean(0);
        for (const Vec3d& own : radiance) {
            mean += own / count;
        }
        Vec3d square(0);
        for (const Vec3d& own : radiance) {
            square += (own - mean) * (own - mean);
        }
        irradiance[point] += std::numbers::pi * mean;
        if (!errors.empty()) {
            const Vec3d by_rays = square * (std::numbers::pi * std::numbers::pi / (count * (count - 1)));
            errors[point] = glm::sqrt(errors[point] * errors[point] + by_rays);
        }
    };
    visit_bounced_light(scene, points, frames, settings, Spread::by_cosine, progress, kDirectShare, visit);
}

}  // namespace

void irradiance(const CompiledScene& scene, std::span<const Vec3d> points, std::span<const Vec3d> normals,
                const PointSettings& settings, std::span<Vec3d> irradiance, std::span<Vec3d> errors,
                const Progress& progress) {
    check_settings(settings);
    check_size("irradiance", irradiance.size(), points.size());
    check_size("errors", errors.size(), errors.empty() ? 0 : points.size());
    if (points.empty()) {
        return;
    }
    QueryProgress part(progress, 0, settings.max_bounces > 0 ? kDirectShare : 1);
    IrradianceQuery(scene, points, normals, settings, part).run(irradiance, errors);
    if (settings.max_bounces > 0) {
        add_bounced(scene, points, normals, settings, progress, irradiance, errors);
    }
}

}  // namespace shlight
