// SPDX-License-Identifier: MIT
//
// With V what a ray sees of a light, w its weight and Y a harmonic, Σ w V Y has the mean ∫ V Y dω. The integral without
// V is known: Σ w V Y + v (∫ Y dω - Σ w Y) has the same mean for any v. Where v is the mean of V, there is no noise if
// all rays agree, and little if most do. Each half of the rays has the v of the other, so that v does not depend on its
// sums.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <variant>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "base/checks.h"
#include "lighting/pixel_points.h"
#include "lighting/ray_sums.h"
#include "lighting/shadow_targets.h"
#include "lights/delta_lights.h"
#include "queries/bounced_light.h"
#include "queries/query_points.h"
#include "queries/query_progress.h"
#include "queries/unshadowed_coefficients.h"
#include "shlight/basis.h"
#include "shlight/sampling.h"
#include "shlight/scene_queries.h"

namespace shlight {
namespace {

constexpr std::size_t kBatchPoints = 256;
/// Shadow rays of a batch for each light, unless a point has more.
constexpr std::size_t kBatchRays = std::size_t{1} << 15;
/// Points over which lights are summed whose coefficients are not known exactly.
constexpr std::uint32_t kSumPoints = 4096;
/// Seed of these, the same for all points.
constexpr std::uint32_t kSumSeed = 0xFFFFFFFBU;

/// row: of RGB.
void add_to(std::span<double> rows, std::size_t row, const Vec3d& value) {
    for (int channel = 0; channel < 3; ++channel) {
        rows[3 * row + static_cast<std::size_t>(channel)] += value[channel];
    }
}

/// A point that a light shines on, and the rays from there, begin … end - 1 of DrawnRays. The two halves of them,
/// between which `middle` is, are independent.
struct Run {
    std::size_t hit, begin, middle, end;
};

/// The coefficients at some points; one per thread.
class PointCoefficients {
  public:
    PointCoefficients(const CompiledScene& scene, int order, const PointSettings& settings)
        : scene_(&scene),
          order_(order),
          width_(static_cast<std::size_t>(coefficient_count(order))),
          rays_(static_cast<std::uint32_t>(settings.rays)),
          points_(scene),
          tracer_(scene.rays(), static_cast<std::uint32_t>(settings.transparent_bounces)),
          environment_(scene.environment(), nullptr),
          deltas_(scene.lights().subspan(scene.extended_light_count())) {}

    /// coefficients: points × order² × RGB; variances: likewise, or none.
    void find(std::span<const Vec3d> points, std::span<const ShadingFrame> frames, std::span<const std::uint32_t> seeds,
              std::span<double> coefficients, std::span<double> variances);

  private:
    void add_light(const Light& light);
    void add_environment();
    void add_deltas(std::size_t hit);
    /// Sets whole_ of a light of even radiance, whose regions unshadowed_ has.
    void take_exact();
    /// Sets whole_ by points of the light.
    void sum_points(ShadowTarget& target);
    std::uint32_t first_half() const { return (rays_ + 1) / 2; }
    /// Adds the light of the runs. strength: of whole_ and the rays.
    void add(ShadowTarget& target, std::uint32_t number, bool casts_shadows, const Vec3d& strength);
    void draw(ShadowTarget& target, std::uint32_t count, std::uint32_t seed);
    /// Finds radiance and density of all rays.
    void complete(ShadowTarget& target);
    /// The weights and harmonics of a run's rays, of which so many were drawn.
    void weigh(const Run& run, double count);
    void add_seen(const Run& run, const Vec3d& strength);
    /// ray: counted from the run's first.
    static std::size_t half_of(const Run& run, std::size_t ray) { return run.begin + ray < run.middle ? 0 : 1; }
    /// Whether a ray is not blocked, or does not count.
    bool is_open(std::size_t ray) const { return drawn_.drawn[ray].hidden_layer || drawn_.visible[ray] == Rgb(1); }
    void add_value(std::size_t hit, std::size_t harmonic, const Vec3d& value) {
        add_to(coefficients_, hit * width_ + harmonic, value);
    }

    const CompiledScene* scene_;
    int order_;
    std::size_t width_;
    std::uint32_t rays_;
    QueryPoints points_;
    ShadowTracer tracer_;
    LightTarget light_;
    EnvironmentTarget environment_;
    DeltaLights deltas_;
    DeltaViews delta_views_;
    UnshadowedCoefficients unshadowed_;
    std::span<const std::uint32_t> seeds_;
    std::span<double> coefficients_, variances_;

    // The light at hand:
    std::vector<Run> runs_;
    std::vector<Vec3d> whole_;  // for each point and harmonic, without shadows
    std::vector<double> exact_;
    DrawnRays drawn_;
    PixelPoints square_ = PixelPoints(1);
    std::vector<std::size_t> numbers_;
    std::vector<Vec3d> ways_;     // of a run's rays, in the point's frame
    std::vector<Vec3d> weights_;  // likewise
    std::vector<double> basis_;   // likewise
};

void PointCoefficients::find(std::span<const Vec3d> points, std::span<const ShadingFrame> frames,
                             std::span<const std::uint32_t> seeds, std::span<double> coefficients,
                             std::span<double> variances) {
    points_.set(points, frames);
    seeds_ = seeds;
    coefficients_ = coefficients;
    variances_ = variances;
    std::fill(coefficients.begin(), coefficients.end(), 0.0);
    std::fill(variances.begin(), variances.end(), 0.0);
    for (const Light& light : scene_->lights().first(scene_->extended_light_count())) {
        if (traits_of(light).links.lights(0)) {
            add_light(light);
        }
    }
    if (!scene_->environment().is_black()) {
        add_environment();
    }
    for (std::size_t hit = 0; hit < points.size() && deltas_.padded_size() > 0; ++hit) {
        add_deltas(hit);
    }
}

void PointCoefficients::add_light(const Light& light) {
    const Hits& hits = points_.hits();
    light_.set(light);
    light_.clear();
    runs_.clear();
    for (std::size_t hit = 0; hit < hits.size(); ++hit) {
        if (light_.add(hits, hit)) {
            runs_.push_back({hit, 0, 0, 0});
        }
    }
    if (UnshadowedCoefficients::knows(light)) {
        for (const Run& run : runs_) {
            unshadowed_.look(light, hits.frame[run.hit], hits.error[run.hit], static_cast<std::uint32_t>(run.hit));
        }
        take_exact();
    } else {
        sum_points(light_);
    }
    const auto number = static_cast<std::uint32_t>(&light - scene_->lights().data());
    // Rays to a light with faces have its radiance, others its share of the light's.
    const auto* mesh = std::get_if<MeshLight>(&light);
    const bool has_faces = mesh != nullptr && mesh->faces != nullptr;
    const Vec3d strength(has_faces ? Rgb(1) : strength_of(light));
    add(light_, number, traits_of(light).casts_shadows, strength);
}

void PointCoefficients::add_environment() {
    environment_.clear();
    runs_.clear();
    for (std::size_t hit = 0; hit < points_.hits().size(); ++hit) {
        runs_.push_back({hit, 0, 0, 0});
    }
    if (scene_->environment().map() == nullptr) {
        for (const Run& run : runs_) {
            unshadowed_.add_hemisphere(static_cast<std::uint32_t>(run.hit));
        }
        take_exact();
    } else {
        sum_points(environment_);
    }
    add(environment_, static_cast<std::uint32_t>(scene_->lights().size()), true, Vec3d(environment_.strength()));
}

void PointCoefficients::take_exact() {
    exact_.assign(points_.hits().size() * width_, 0.0);
    unshadowed_.move_to(order_, exact_);
    whole_.resize(exact_.size());
    std::transform(exact_.begin(), exact_.end(), whole_.begin(), [](double value) { return Vec3d(value); });
}

void PointCoefficients::sum_points(ShadowTarget& target) {
    whole_.assign(points_.hits().size() * width_, Vec3d(0));
    for (std::size_t i = 0; i < runs_.size(); ++i) {
        const std::size_t hit = runs_[i].hit;
        drawn_.clear();
        target.aim(points_.hits(), hit, i, true);
        draw(target, kSumPoints, kSumSeed);
        complete(target);
        weigh({hit, 0, 0, drawn_.size()}, kSumPoints);
        for (std::size_t ray = 0; ray < drawn_.size(); ++ray) {
            for (std::size_t k = 0; k < width_; ++k) {
                whole_[hit * width_ + k] += weights_[ray] * basis_[ray * width_ + k];
            }
        }
    }
}

void PointCoefficients::draw(ShadowTarget& target, std::uint32_t count, std::uint32_t seed) {
    square_.start({0, 1, count, 0}, 0, 0, seed);
    const auto [u, v] = square_.of(0, 0, count);
    if (target.draws()) {
        target.draw(u, v, count, drawn_);
        return;
    }
    // An environment of one radiance is met in directions that are spread evenly over the half space.
    std::array<float, kRaysAtOnce> x{};
    std::array<float, kRaysAtOnce> y{};
    std::array<float, kRaysAtOnce> z{};
    for (std::uint32_t first = 0; first < count; first += kRaysAtOnce) {
        const std::uint32_t some = std::min(kRaysAtOnce, count - first);
        for (std::uint32_t i = 0; i < some; ++i) {
            const float azimuth = 2 * std::numbers::pi_v<float> * v[first + i];
            const float sine = std::sqrt(1 - u[first + i] * u[first + i]);
            x[i] = sine * std::cos(azimuth);
            y[i] = sine * std::sin(azimuth);
            z[i] = u[first + i];
        }
        target.meet({x.data(), y.data(), z.data()}, some, kDiffuseRay, drawn_);
    }
}

void PointCoefficients::complete(ShadowTarget& target) {
    numbers_.resize(drawn_.size());
    std::iota(numbers_.begin(), numbers_.end(), std::size_t{0});
    target.find_radiance(numbers_, drawn_);
}

void PointCoefficients::weigh(const Run& run, double count) {
    ways_.clear();
    weights_.clear();
    for (std::size_t ray = run.begin; ray < run.end; ++ray) {
        const DrawnRay& drawn = drawn_.drawn[ray];
        Vec3d color = drawn_.color.empty() ? Vec3d(1) : Vec3d(drawn_.color[ray]);
        color += drawn_.spot_color.empty() ? Vec3d(0) : Vec3d(drawn_.spot_color[ray]);
        const double density = drawn.light_density > 0 ? double{drawn.light_density} : 1 / (2 * std::numbers::pi);
        const double weight = drawn.hidden_layer ? 0.0 : double{drawn.radiance} / (density * count);
        ways_.push_back(points_.hits().frame[run.hit].to_local(Vec3d(drawn.way)));
        weights_.push_back(weight * color);
    }
    basis_.resize(ways_.size() * width_);
    sh_basis<double>(ways_, order_, basis_);
}

void PointCoefficients::add(ShadowTarget& target, std::uint32_t number, bool casts_shadows, const Vec3d& strength) {
    const bool shadows = casts_shadows && rays_ > 0;
    drawn_.clear();
    for (std::size_t i = 0; i < runs_.size() && shadows; ++i) {
        target.aim(points_.hits(), runs_[i].hit, i, true);
        runs_[i].begin = drawn_.size();
        const std::uint32_t seed = hash(seeds_[runs_[i].hit], number);
        draw(target, first_half(), hash(seed, 0));
        runs_[i].middle = drawn_.size();
        draw(target, rays_ - first_half(), hash(seed, 1));
        runs_[i].end = drawn_.size();
    }
    target.trace(tracer_, drawn_);
    complete(target);
    for (const Run& run : runs_) {
        bool any_hidden = false;
        for (std::size_t ray = run.begin; ray < run.end; ++ray) {
            any_hidden = any_hidden || !is_open(ray);
        }
        if (any_hidden) {
            add_seen(run, strength);
            continue;
        }
        for (std::size_t k = 0; k < width_; ++k) {
            add_value(run.hit, k, strength * whole_[run.hit * width_ + k]);
        }
    }
}

void PointCoefficients::add_seen(const Run& run, const Vec3d& strength) {
    weigh(run, rays_);
    std::array<RaySums, 2> halves;
    for (std::size_t i = 0; i < weights_.size(); ++i) {
        halves[half_of(run, i)].add(weights_[i], drawn_.visible[run.begin + i]);
    }
    std::array<Vec3d, 2> kept;  // by the rays of each half, for those of the other
    for (std::size_t half = 0; half < 2; ++half) {
        const RaySums& others = halves[1 - half];
        const RaySums& sums = others.all == Vec3d(0) ? halves[half] : others;
        kept[half] = quotient(sums.seen, sums.all);
    }
    const double share = 1.0 * first_half() / rays_;
    const std::array<double, 2> shares = {share, 1 - share};
    for (std::size_t k = 0; k < width_; ++k) {
        std::array<Vec3d, 2> sums;
        for (std::size_t half = 0; half < 2; ++half) {
            sums[half] = shares[half] * kept[half] * whole_[run.hit * width_ + k];
        }
        for (std::size_t i = 0; i < weights_.size(); ++i) {
            const std::size_t half = half_of(run, i);
            sums[half] += (Vec3d(drawn_.visible[run.begin + i]) - kept[half]) * weights_[i] * basis_[i * width_ + k];
        }
        add_value(run.hit, k, strength * (sums[0] + sums[1]));
        if (!variances_.empty()) {
            const Vec3d apart = strength * (sums[0] / shares[0] - sums[1] / shares[1]);
            add_to(variances_, run.hit * width_ + k, shares[0] * shares[1] * apart * apart);
        }
    }
}

void PointCoefficients::add_deltas(std::size_t hit) {
    const Hits& hits = points_.hits();
    deltas_.see({0, deltas_.padded_size()}, hits.frame[hit], hits.error[hit], delta_views_);
    numbers_.clear();
    ways_.clear();
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < deltas_.padded_size(); ++i) {
        if (delta_views_.irradiance[i] > 0 && deltas_.lights(i, 0) &&
            deltas_.shines(i, hits.frame[hit], hits.error[hit])) {
            numbers_.push_back(i);
            ways_.emplace_back(delta_views_.x[i], delta_views_.y[i], delta_views_.z[i]);
            rays.push_back(deltas_.ray(i, hits.shadow_origin[hit]));
        }
    }
    std::vector<Rgb> visible(rays.size(), Rgb(1));
    if (rays_ > 0) {
        tracer_.visibility(rays, visible);
    }
    basis_.resize(ways_.size() * width_);
    sh_basis<double>(ways_, order_, basis_);
    for (std::size_t i = 0; i < numbers_.size(); ++i) {
        const Vec3d seen(deltas_.casts_shadows(numbers_[i]) ? visible[i] : Rgb(1));
        const Vec3d light = delta_views_.irradiance[numbers_[i]] * seen * Vec3d(deltas_.strength(numbers_[i]));
        for (std::size_t k = 0; k < width_; ++k) {
            add_value(hit, k, light * basis_[i * width_ + k]);
        }
    }
}

/// The coefficients that rays of a point, spread evenly over its half space, bring, and their variances if there are
/// any.
void add_bounced_rays(std::span<const Vec3d> ways, std::span<const Vec3d> radiance, int order,
                      std::span<double> coefficients, std::span<double> variances) {
    const auto width = static_cast<std::size_t>(coefficient_count(order));
    const auto count = static_cast<double>(ways.size());
    std::vector<double> basis(ways.size() * width);
    sh_basis<double>(ways, order, basis);
    for (std::size_t k = 0; k < width; ++k) {
        Vec3d sum(0);
        Vec3d squares(0);
        for (std::size_t ray = 0; ray < ways.size(); ++ray) {
            const Vec3d own = 2 * std::numbers::pi * basis[ray * width + k] * radiance[ray];
            sum += own;
            squares += own * own;
        }
        add_to(coefficients, k, sum / count);
        if (!variances.empty()) {
            const Vec3d square = glm::max(squares / count - sum * sum / (count * count), Vec3d(0));
            add_to(variances, k, square / (count - 1));
        }
    }
}

}  // namespace

void light_coefficients(const CompiledScene& scene, std::span<const Vec3d> points, std::span<const glm::dmat3> frames,
                        int order, const PointSettings& settings, std::span<double> coefficients,
                        std::span<double> errors, const Progress& progress) {
    check_order(order);
    check_settings(settings);
    const std::size_t width = 3 * static_cast<std::size_t>(coefficient_count(order));
    check_size("frames", frames.size(), points.size());
    check_size("coefficients", coefficients.size(), points.size() * width);
    check_size("errors", errors.size(), errors.empty() ? 0 : points.size() * width);
    if (!errors.empty() && settings.rays == 1) {
        reject("rays must be 0 or at least 2 to tell errors, got 1");
    }
    std::vector<ShadingFrame> axes;
    for (std::size_t i = 0; i < points.size(); ++i) {
        axes.push_back({points[i], frames[i][0], frames[i][1], frames[i][2]});
    }
    const auto rows = [&](std::span<double> all, std::size_t first, std::size_t count) {
        return all.empty() ? all : all.subspan(first * width, count * width);
    };
    QueryProgress part(progress, 0, settings.max_bounces > 0 ? kDirectShare : 1);
    part.start(points.size());
    tbb::enumerable_thread_specific<PointCoefficients> all([&] { return PointCoefficients(scene, order, settings); });
    const std::size_t size = std::clamp<std::size_t>(kBatchRays / std::max(settings.rays, 1), 1, kBatchPoints);
    parallel_for((points.size() + size - 1) / size, settings.threads, [&](std::size_t batch) {
        part.add(0);
        const std::size_t first = batch * size;
        const std::size_t count = std::min(size, points.size() - first);
        std::vector<std::uint32_t> seeds;
        for (std::size_t i = first; i < first + count; ++i) {
            seeds.push_back(hash(static_cast<std::uint32_t>(i), settings.seed));
        }
        all.local().find(points.subspan(first, count), std::span(axes).subspan(first, count), seeds,
                         rows(coefficients, first, count), rows(errors, first, count));
        part.add(count);
    });
    if (settings.max_bounces > 0) {
        const auto visit = [&](std::size_t point, std::span<const Vec3d> ways, std::span<const Vec3d> radiance) {
            add_bounced_rays(ways, radiance, order, rows(coefficients, point, 1), rows(errors, point, 1));
        };
        visit_bounced_light(scene, points, axes, settings, Spread::evenly, progress, kDirectShare, visit);
    }
    std::transform(errors.begin(), errors.end(), errors.begin(), [](double variance) { return std::sqrt(variance); });
}

}  // namespace shlight
