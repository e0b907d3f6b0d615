// SPDX-License-Identifier: MIT
#include "shlight/fixed_view.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <iterator>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "base/checks.h"
#include "film/light_layers.h"
#include "film/pilot.h"
#include "film/pixel_batch.h"
#include "film/pixel_order.h"
#include "film/refinement.h"
#include "lighting/ray_sums.h"
#include "surfaces/placed_meshes.h"

namespace shlight {
namespace {

/// Hits of a batch, at most: the arrays of one light stay in the cache.
constexpr std::uint32_t kMostHits = 1024;
/// Shadow rays of a camera ray and light in all passes, at most.
constexpr std::uint32_t kMostRays = 1 << 14;

/// Whether camera rays meet the same surfaces.
bool meets_alike(const CompiledScene& a, const CompiledScene& b) {
    return a.origin() == b.origin() && std::ranges::equal(a.placed().meshes(), b.placed().meshes());
}

/// Whether camera rays that meet the same surfaces see the same lamps and the same environment. mirrors: they meet.
bool sees_alike(const CompiledScene& a, const CompiledScene& b, bool mirrors) {
    const auto visible = [&](const CompiledScene& scene) {
        std::vector<Light> seen;
        std::ranges::copy_if(scene.lights(), std::back_inserter(seen),
                             [&](const Light& light) { return mirrors || traits_of(light).seen_by_camera; });
        return seen;
    };
    return a.environment() == b.environment() && a.background() == b.background() &&
           a.background_visible() == b.background_visible() && visible(a) == visible(b);
}

/// The lights of some layers, as DirectLighting takes them.
struct LitLayers {
    LitLayers(std::span<LightLayer*> some, const Picture& all) : layers(some.begin(), some.end()) {
        std::stable_partition(layers.begin(), layers.end(), [](const LightLayer* layer) { return layer->extended; });
        bool environment = false;
        for (const LightLayer* layer : layers) {
            lights.insert(lights.end(), layer->lights.begin(), layer->lights.end());
            extended += layer->extended ? layer->lights.size() : 0;
            environment = environment || layer->is_environment();
        }
        std::size_t begin = 0;
        for (const LightLayer* layer : layers) {
            const std::size_t end = begin + layer->lights.size();
            if (!layer->extended) {
                deltas.emplace_back(std::span(lights).subspan(begin, end - begin));
            }
            selections.push_back(
                {layer->extended ? begin : 0, layer->extended ? end : 0, nullptr, layer->is_environment()});
            begin = end;
        }
        std::size_t delta = 0;
        for (std::size_t i = 0; i < layers.size(); ++i) {
            selections[i].deltas = layers[i]->extended ? nullptr : &deltas[delta++];
        }
        lighting.emplace(lights, extended, environment ? *all.lighting.environment : black, 0, all.lighting.materials,
                         all.settings.order, all.settings.tolerance);
        lighting->follow(all.lighting);
    }

    std::vector<LightLayer*> layers;  // those with extent and the environment first
    std::vector<Light> lights;
    std::size_t extended = 0;
    std::vector<DeltaLights> deltas;  // of each layer without extent
    std::vector<LightSelection> selections;
    Environment black;
    std::optional<LightingScene> lighting;
};

}  // namespace

class FixedView::State {
  public:
    State(const Camera& camera, int width, int height, const RenderSettings& settings)
        : camera_(camera), width_(width), height_(height), settings_(settings) {
        settings_.sampling = PixelSampling::fixed(settings.sampling.max_samples);
        settings_.max_bounces = 0;
        settings_.passes = {};
        check_render(settings_, width, height);
    }

    int width() const { return width_; }
    int height() const { return height_; }
    int threads() const { return settings_.threads; }
    RenderReport relight(const std::shared_ptr<const CompiledScene>& scene, double noise_threshold,
                         std::span<float> image, const Stopped& stopped);

  private:
    /// Pixels that are lit together.
    struct Batch {
        std::vector<Pixel> pixels;
        std::vector<std::uint32_t> seeds, penumbrae;
        Hits hits;
        ShadingPoints points;
    };
    /// One per thread.
    struct Worker {
        Worker(const LightingScene& lights, const Picture& picture)
            : lighting(lights, picture.scene->rays(), static_cast<std::uint32_t>(picture.settings.transparent_bounces),
                       kWholeLight) {}

        DirectLighting lighting;
        std::vector<float> others;
        RenderReport report;
    };

    std::uint32_t samples() const { return static_cast<std::uint32_t>(settings_.sampling.max_samples); }
    std::size_t pixel_count() const { return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_); }
    std::size_t index(const Pixel& pixel) const {
        return static_cast<std::size_t>(pixel.row) * static_cast<std::size_t>(width_) +
               static_cast<std::size_t>(pixel.column);
    }
    /// body(row, begin, end): of the row's pixels.
    template <class Body>
    void for_each_row(const Body& body) const {
        const auto columns = static_cast<std::size_t>(width_);
        parallel_for(static_cast<std::size_t>(height_), settings_.threads,
                     [&](std::size_t row) { body(row, row * columns, (row + 1) * columns); });
    }
    void trace(const Picture& picture, const Stopped& stopped);
    void find_points(const Picture& picture, Batch& batch) const;
    /// A pass of shadow rays over some layers in some batches: as many as those before together. wanted(layer, batch):
    /// whether the layer takes part there.
    template <class Wanted>
    void light(LitLayers& lit, std::span<const std::size_t> batches, const Picture& picture, const Stopped& stopped,
               const Wanted& wanted);
    void light(LitLayers& lit, std::size_t i, std::size_t number, Worker& worker);
    /// The brightness of each pixel by what is known of other layers.
    void find_others(const LitLayers& lit);
    void add_unblocked(LightLayer& layer, const UnshadowedLight& light, const Batch& batch) const;
    void add_shadowed(LightLayer& layer, const Batch& batch, std::uint32_t before, std::uint32_t rays) const;
    /// The mean over the channels of a pixel's variance ÷ the square of what it is relative to.
    double relative_square(const Rgb& variance, const float* color) const;
    /// Mean square over the pixels of a batch of the relative error by a layer.
    double squared_error(const LightLayer& layer, std::size_t number, std::span<const float> image) const;
    /// A pass where there is too much noise. Returns false if there is nothing to do.
    bool refine(double threshold, const Picture& picture, std::span<const float> image, const Stopped& stopped);
    /// The image, and its noise.
    void compose(std::span<float> image);

    Camera camera_;
    int width_, height_;
    RenderSettings settings_;
    std::shared_ptr<const CompiledScene> scene_;  // of the last call; null: nothing is known
    std::vector<Batch> batches_;
    bool mirrors_ = false;
    std::vector<float> background_;  // RGBA: of what camera rays meet besides what surfaces reflect
    std::vector<LightLayer> layers_;
    std::vector<float> others_;  // see find_others()
    double least_square_ = 0;    // see PixelSampling::noise_threshold
    RenderReport report_;
};

void FixedView::State::trace(const Picture& picture, const Stopped& stopped) {
    const std::uint32_t most = std::min(kMostHits, picture.lighting.batch_size());
    const Grid whole = {1, 0};
    const std::vector<Tile> tiles = tiles_of(width_, height_, whole, samples(), most);
    batches_.assign(tiles.size(), {{}, {}, {}, Hits(picture.lighting.lobe_stride), {}});
    background_.assign(4 * pixel_count(), 0);
    tbb::enumerable_thread_specific<PixelBatch> tracers([&] { return PixelBatch(picture, picture.paths(nullptr)); });
    parallel_for(tiles.size(), settings_.threads, [&](std::size_t i) {
        end_if(stopped);
        Batch& batch = batches_[i];
        batch.pixels = pixels_of(tiles[i], whole);
        PixelBatch& tracer = tracers.local();
        Hits hits(picture.lighting.lobe_stride);
        std::vector<RayLight> light;
        tracer.trace(batch.pixels, {0, samples(), 0, 0}, hits, light);
        batch.hits = hits;  // without the room that it grew by
        batch.seeds.assign(tracer.pixel_seeds().begin(), tracer.pixel_seeds().end());
        batch.penumbrae.assign(batch.pixels.size(), LightBits::kAll);
        for (std::size_t p = 0; p < batch.pixels.size(); ++p) {
            Vec3d radiance(0);
            double opacity = 0;
            for (const RayLight& ray : std::span(light).subspan(p * samples(), samples())) {
                radiance += Vec3d(ray.radiance);
                opacity += double{ray.opacity};
            }
            float* own = &background_[4 * index(batch.pixels[p])];
            const Rgb mean(radiance / (1.0 * samples()));
            std::copy_n(&mean.x, 3, own);
            own[3] = static_cast<float>(opacity / samples());
        }
    });
    mirrors_ = false;
    for (PixelBatch& tracer : tracers) {
        const RenderReport report = tracer.take_report();
        report_ += report;
        mirrors_ = mirrors_ || report.mirror_count > 0;
    }
}

/// Which hits share a point depends on how near lights are.
void FixedView::State::find_points(const Picture& picture, Batch& batch) const {
    if (batch.points.pixel_begin.size() <= 1 || batch.hits.size() > batch.pixels.size()) {
        const LightingScene& all = picture.lighting;
        batch.points.assign(batch.hits, all.materials, all.extended, all.deltas, all.tolerance);
    }
}

void FixedView::State::find_others(const LitLayers& lit) {
    others_.assign(settings_.shadow_rays > 0 ? pixel_count() : 0, 0);
    for (const LightLayer& layer : layers_) {
        if (others_.empty() || std::ranges::find(lit.layers, &layer) != lit.layers.end()) {
            continue;
        }
        const Rgb factor = static_cast<float>(samples()) * layer.gain;
        for_each_row([&](std::size_t, std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                others_[i] += glm::dot(glm::abs(layer.radiance[i]), factor);
            }
        });
    }
}

void FixedView::State::add_unblocked(LightLayer& layer, const UnshadowedLight& light, const Batch& batch) const {
    const ShadingPoints& points = batch.points;
    const std::size_t lobes = batch.hits.lobe_stride;
    for (std::size_t p = 0; p < batch.pixels.size(); ++p) {
        Rgb sum(0);
        for (std::size_t point = points.pixel_begin[p]; point < points.pixel_begin[p + 1]; ++point) {
            Rgb own(0);
            for (std::size_t lobe = 0; lobe < lobes; ++lobe) {
                own += points.weight(point, lobe) * light[lobe * points.size() + point];
            }
            sum += static_cast<float>(points.hit_count(point)) * own;
        }
        layer.radiance[index(batch.pixels[p])] += sum / static_cast<float>(samples());
    }
}

void FixedView::State::add_shadowed(LightLayer& layer, const Batch& batch, std::uint32_t before,
                                    std::uint32_t rays) const {
    const double share = rays > 0 ? 1.0 * before / (1.0 * before + rays) : 0;
    // Rays are spread evenly over the light, and the edge of a shadow crosses it: see RenderReport::noise.
    const double evenness = 1 / std::sqrt(1.0 * std::max(rays, 1U) * samples());
    const double count = samples();
    for (std::size_t p = 0; p < batch.pixels.size(); ++p) {
        Vec3d radiance(0);
        Vec3d noise(0);
        for (std::size_t hit = batch.hits.pixel_begin[p]; hit < batch.hits.pixel_begin[p + 1]; ++hit) {
            radiance += Vec3d(batch.hits.radiance[hit]);
            noise += Vec3d(batch.hits.noise[hit]);
        }
        const Vec3d variance = (evenness * noise + Vec3d(batch.hits.shared_noise[p])) / (count * count);
        Rgb& own = layer.radiance[index(batch.pixels[p])];
        own = Rgb(share * Vec3d(own) + (1 - share) * radiance / count);
        if (!layer.variance.empty()) {
            Rgb& uncertain = layer.variance[index(batch.pixels[p])];
            uncertain = Rgb(share * share * Vec3d(uncertain) + (1 - share) * (1 - share) * variance);
        }
    }
}

void FixedView::State::light(LitLayers& lit, std::size_t i, std::size_t number, Worker& worker) {
    Batch& batch = batches_[number];
    LightLayer& layer = *lit.layers[i];
    if (settings_.shadow_rays == 0 && layer.extended) {
        const LightSelection& own = lit.selections[i];
        for (std::size_t light = own.begin; light < own.end; ++light) {
            add_unblocked(layer, worker.lighting.unshadowed()[light], batch);
        }
        if (own.environment) {
            add_unblocked(layer, worker.lighting.unshadowed().back(), batch);
        }
        return;
    }
    Hits& hits = batch.hits;
    std::ranges::fill(hits.radiance, Rgb(0));
    std::ranges::fill(hits.noise, Rgb(0));
    std::ranges::fill(hits.shared_noise, Rgb(0));
    std::uint32_t& before = layer.rays[number];
    const std::uint32_t rays = before > 0 ? before : static_cast<std::uint32_t>(settings_.shadow_rays);
    worker.lighting.add(lit.selections[i], batch.seeds, {0, samples(), rays, before * samples()}, hits, worker.report);
    add_shadowed(layer, batch, before, rays);
    before += rays;
}

template <class Wanted>
void FixedView::State::light(LitLayers& lit, std::span<const std::size_t> batches, const Picture& picture,
                             const Stopped& stopped, const Wanted& wanted) {
    find_others(lit);
    tbb::enumerable_thread_specific<Worker> workers([&] { return Worker(*lit.lighting, picture); });
    parallel_for(batches.size(), settings_.threads, [&](std::size_t k) {
        end_if(stopped);
        const std::size_t number = batches[k];
        Worker& worker = workers.local();
        const Batch& batch = batches_[number];
        worker.lighting.find(batch.points, worker.report);
        if (settings_.shadow_rays > 0 || !lit.deltas.empty()) {
            worker.others.clear();
            for (const Pixel& pixel : others_.empty() ? std::span<const Pixel>() : batch.pixels) {
                worker.others.push_back(others_[index(pixel)]);
            }
            worker.lighting.share_out(batch.penumbrae, worker.others);
        }
        for (std::size_t i = 0; i < lit.layers.size(); ++i) {
            if (wanted(*lit.layers[i], number)) {
                light(lit, i, number, worker);
            }
        }
    });
    for (const Worker& worker : workers) {
        report_ += worker.report;
    }
    ++report_.passes;
}

double FixedView::State::relative_square(const Rgb& variance, const float* color) const {
    const Vec3d relative = quotient(Vec3d(variance), squared({color[0], color[1], color[2]}) + least_square_);
    return (relative.x + relative.y + relative.z) / 3;
}

double FixedView::State::squared_error(const LightLayer& layer, std::size_t number,
                                       std::span<const float> image) const {
    double sum = 0;
    for (const Pixel& pixel : batches_[number].pixels) {
        const std::size_t i = index(pixel);
        sum += relative_square(layer.gain * layer.gain * layer.variance[i], &image[4 * i]);
    }
    return sum / static_cast<double>(batches_[number].pixels.size());
}

bool FixedView::State::refine(double threshold, const Picture& picture, std::span<const float> image,
                              const Stopped& stopped) {
    const double enough = threshold * threshold;
    const auto count = static_cast<double>(layers_.size());
    std::vector<std::uint8_t> wanted(layers_.size() * batches_.size(), 0);
    std::vector<std::uint8_t> takes_part(layers_.size(), 0);
    std::vector<std::size_t> numbers;
    for (std::size_t number = 0; number < batches_.size(); ++number) {
        std::vector<double> errors;
        for (const LightLayer& layer : layers_) {
            errors.push_back(layer.rays[number] < kMostRays ? squared_error(layer, number, image) : 0);
        }
        if (std::reduce(errors.begin(), errors.end()) <= enough) {
            continue;
        }
        for (std::size_t i = 0; i < layers_.size(); ++i) {
            const bool is_noisy = errors[i] * count > enough;
            wanted[number * layers_.size() + i] = is_noisy ? 1 : 0;
            takes_part[i] |= is_noisy ? 1 : 0;
        }
        numbers.push_back(number);
    }
    std::vector<LightLayer*> some;
    for (std::size_t i = 0; i < layers_.size(); ++i) {
        if (takes_part[i] != 0) {
            some.push_back(&layers_[i]);
        }
    }
    if (some.empty()) {
        return false;
    }
    LitLayers lit(some, picture);
    light(lit, numbers, picture, stopped, [&](const LightLayer& layer, std::size_t number) {
        return wanted[number * layers_.size() + static_cast<std::size_t>(&layer - layers_.data())] != 0;
    });
    return true;
}

void FixedView::State::compose(std::span<float> image) {
    std::vector<double> of_rows(static_cast<std::size_t>(height_));
    const auto mean_over_rows = [&] {
        return std::reduce(of_rows.begin(), of_rows.end()) / static_cast<double>(pixel_count());
    };
    for_each_row([&](std::size_t row, std::size_t begin, std::size_t end) {
        std::vector<Rgb> radiance;
        for (std::size_t i = begin; i < end; ++i) {
            radiance.emplace_back(background_[4 * i], background_[4 * i + 1], background_[4 * i + 2]);
        }
        for (const LightLayer& layer : layers_) {
            for (std::size_t i = begin; i < end; ++i) {
                radiance[i - begin] += layer.gain * layer.radiance[i];
            }
        }
        Vec3d sum(0);
        for (std::size_t i = begin; i < end; ++i) {
            const Rgb& own = radiance[i - begin];
            std::copy_n(&own.x, 3, &image[4 * i]);
            image[4 * i + 3] = background_[4 * i + 3];
            sum += Vec3d(own);
        }
        of_rows[row] = (sum.x + sum.y + sum.z) / 3;
    });
    const double mean = mean_over_rows();
    least_square_ = 0.01 * mean * mean;
    report_.noise = 0;
    if (settings_.shadow_rays == 0) {
        return;
    }
    for_each_row([&](std::size_t row, std::size_t begin, std::size_t end) {
        std::vector<Rgb> variance(end - begin, Rgb(0));
        for (const LightLayer& layer : layers_) {
            for (std::size_t i = begin; i < end; ++i) {
                variance[i - begin] += layer.gain * layer.gain * layer.variance[i];
            }
        }
        of_rows[row] = 0;
        for (std::size_t i = begin; i < end; ++i) {
            of_rows[row] += relative_square(variance[i - begin], &image[4 * i]);
        }
    });
    report_.noise = std::sqrt(mean_over_rows());
}

RenderReport FixedView::State::relight(const std::shared_ptr<const CompiledScene>& scene, double noise_threshold,
                                       std::span<float> image, const Stopped& stopped) {
    const auto start = std::chrono::steady_clock::now();
    report_ = {};
    const std::shared_ptr<const CompiledScene> before = std::exchange(scene_, nullptr);  // if this throws
    const bool same_hits = before && meets_alike(*before, *scene);
    const Refinement fixed(1, 1, settings_.sampling, camera_.has_depth_of_field());
    Picture picture(*scene, camera_, width_, height_, settings_, pixel_points(fixed, settings_.seed), 0, stopped);
    if (settings_.order == 0 || !scene->environment().is_black()) {
        look_ahead(picture, stopped);
    }
    std::vector<LightLayer> known = same_hits ? std::exchange(layers_, {}) : std::vector<LightLayer>();
    const bool same_environment = same_hits && before->environment() == scene->environment();
    layers_ = layers_of(*scene, picture.lighting.light_error, same_environment, known);
    if (!same_hits || !sees_alike(*before, *scene, mirrors_)) {
        trace(picture, stopped);
    }
    std::vector<LightLayer*> unknown;
    for (LightLayer& layer : layers_) {
        if (!layer.is_known()) {
            layer.light_error = picture.lighting.light_error;
            layer.radiance.assign(pixel_count(), Rgb(0));
            layer.variance.assign(settings_.shadow_rays > 0 ? pixel_count() : 0, Rgb(0));
            layer.rays.assign(batches_.size(), 0);
            unknown.push_back(&layer);
        }
    }
    if (!unknown.empty()) {
        parallel_for(batches_.size(), settings_.threads, [&](std::size_t i) { find_points(picture, batches_[i]); });
        std::vector<std::size_t> all(batches_.size());
        std::iota(all.begin(), all.end(), 0U);
        LitLayers lit(unknown, picture);
        light(lit, all, picture, stopped, [](const LightLayer&, std::size_t) { return true; });
    }
    compose(image);
    while (report_.noise > noise_threshold && refine(noise_threshold, picture, image, stopped)) {
        compose(image);
    }
    scene_ = scene;
    report_.hits = std::accumulate(batches_.begin(), batches_.end(), std::uint64_t{0},
                                   [](std::uint64_t sum, const Batch& batch) { return sum + batch.hits.size(); });
    report_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return report_;
}

FixedView::FixedView(const Camera& camera, int width, int height, const RenderSettings& settings)
    : state_(std::make_unique<State>(camera, width, height, settings)) {}

FixedView::~FixedView() = default;

int FixedView::width() const {
    return state_->width();
}

int FixedView::height() const {
    return state_->height();
}

RenderReport FixedView::relight(const std::shared_ptr<const CompiledScene>& scene, double noise_threshold,
                                std::span<float> image, const Progress& progress) {
    if (!(noise_threshold > 0)) {
        reject("noise_threshold must be positive");
    }
    check_size("image", image.size(),
               4 * static_cast<std::size_t>(state_->width()) * static_cast<std::size_t>(state_->height()));
    RenderReport report;
    const auto work = [&](const Watch& caller) {
        report = state_->relight(scene, noise_threshold, image, caller.stopped);
    };
    const auto look = [&] { return progress(0); };
    run_watched(state_->threads(), work, progress ? std::function<bool()>(look) : nullptr);
    return report;
}

}  // namespace shlight
