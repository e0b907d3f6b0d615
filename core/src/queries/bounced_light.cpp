// SPDX-License-Identifier: MIT
#include "queries/bounced_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "queries/query_points.h"
#include "queries/query_progress.h"
#include "shlight/sampling.h"

namespace shlight {
namespace {

/// Rays that are followed at a time: enough for all threads, few enough to keep.
constexpr std::size_t kBouncedRays = std::size_t{1} << 18;
/// Points whose rays begin together.
constexpr std::size_t kBouncedPoints = 64;
/// Shadow rays to each light from where a ray meets a surface. Its neighbours have others.
constexpr int kBouncedShadowRays = 4;
constexpr std::uint32_t kWaysSeed = 0xFFFFFFF9U;
constexpr std::uint32_t kPathsSeed = 0xFFFFFFF8U;

Vec3d way_at(const glm::dvec2& point, Spread spread) {
    const double cosine = spread == Spread::by_cosine ? std::sqrt(1 - point.x) : 1 - point.x;
    const double sine = std::sqrt(1 - cosine * cosine);
    const double azimuth = 2 * std::numbers::pi * point.y;
    return {sine * std::cos(azimuth), sine * std::sin(azimuth), cosine};
}

RenderSettings settings_of_rays(const PointSettings& settings, std::size_t first) {
    RenderSettings own;
    own.sampling.min_samples = 1;
    own.sampling.max_samples = 1;
    own.sampling.noise_threshold = 0;
    own.shadow_rays = std::min(settings.rays, kBouncedShadowRays);
    own.transparent_bounces = settings.transparent_bounces;
    own.max_bounces = settings.max_bounces - 1;
    own.threads = settings.threads;
    own.seed = hash(hash(static_cast<std::uint32_t>(first), settings.seed), kPathsSeed);
    return own;
}

/// The rays of some points, and what they see.
struct BouncedRays {
    std::vector<Vec3d> origins, directions, ways, radiance;

    void resize(std::size_t count) {
        for (std::vector<Vec3d>* own : {&origins, &directions, &ways, &radiance}) {
            own->resize(count);
        }
    }
    std::span<const Vec3d> of(const std::vector<Vec3d>& all, std::size_t point, std::size_t each) const {
        return std::span(all).subspan(point * each, each);
    }
};

}  // namespace

void visit_bounced_light(const CompiledScene& scene, std::span<const Vec3d> points,
                         std::span<const ShadingFrame> frames, const PointSettings& settings, Spread spread,
                         const Progress& progress, double from, const VisitBounced& visit) {
    const auto each = static_cast<std::size_t>(settings.bounce_rays);
    const std::size_t at_once = std::max<std::size_t>(1, kBouncedRays / each);
    BouncedRays rays;
    for (std::size_t first = 0; first < points.size(); first += at_once) {
        const std::size_t count = std::min(at_once, points.size() - first);
        rays.resize(count * each);
        parallel_for((count + kBouncedPoints - 1) / kBouncedPoints, settings.threads, [&](std::size_t batch) {
            const std::size_t begin = batch * kBouncedPoints;
            const std::size_t size = std::min(kBouncedPoints, count - begin);
            QueryPoints own(scene);
            own.set(points.subspan(first + begin, size), frames.subspan(first + begin, size));
            for (std::size_t i = begin; i < begin + size; ++i) {
                const auto number = static_cast<std::uint32_t>(first + i);
                const SobolSequence sequence(hash(hash(number, settings.seed), kWaysSeed));
                for (std::size_t ray = 0; ray < each; ++ray) {
                    const std::size_t at = i * each + ray;
                    rays.ways[at] = way_at(sequence.point(static_cast<std::uint32_t>(ray)), spread);
                    rays.origins[at] = own.hits().shadow_origin[i - begin] + scene.origin();
                    rays.directions[at] = frames[first + i].to_world(rays.ways[at]);
                }
            }
        });
        const double size = static_cast<double>(points.size()) / (1 - from);
        QueryProgress part(progress, from + static_cast<double>(first) / size,
                           from + static_cast<double>(first + count) / size);
        radiance(scene, rays.origins, rays.directions, settings_of_rays(settings, first), false, rays.radiance,
                 part.within());
        parallel_for(count, settings.threads, [&](std::size_t i) {
            visit(first + i, rays.of(rays.ways, i, each), rays.of(rays.radiance, i, each));
        });
    }
}

}  // namespace shlight
