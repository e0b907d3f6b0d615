// SPDX-License-Identifier: MIT
#include "film/record_gatherer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include <tbb/parallel_sort.h>

#include "tracing/light_bits.h"

namespace shlight {
namespace {

constexpr std::size_t kCellsAtOnce = 1024;
/// Records, at least, that are made at once where there is a time limit.
constexpr std::size_t kFirstRecords = 8;
/// Rays that share shadow rays, and those that are shaded at once.
constexpr std::size_t kGroupRays = 8;
constexpr std::size_t kShadedAtOnce = 32 * kGroupRays;
/// Rays that are shaded for a cell, at least, and times the root of the number of those that end there.
constexpr std::size_t kLeastSamples = 2;
constexpr double kSamplesPerRoot = 2;
/// The share of a ray's light that surfaces are taken to reflect where that is clamped. A record lights surfaces of any
/// albedo; this is that of Blender's own material.
constexpr float kReflectance = 0.8F;
/// Errors of light that is summed up over faces at the ends of rays ÷ those at hits: a record has hundreds of rays.
constexpr double kFaceErrors = 10;
/// In place of the number of an end.
constexpr std::uint32_t kNone = 0xFFFFFFFFU;

/// The number of records that are made next, of which there is time for most. start, left: seconds before the first
/// record and now.
std::size_t records_at_once(std::size_t made, double start, double left) {
    if (std::isinf(left)) {
        return kRecordsAtOnce;
    }
    const double per_record = made > 0 ? (start - left) / static_cast<double>(made) : start / kFirstRecords;
    return static_cast<std::size_t>(std::clamp(left / per_record, 1.0 * kFirstRecords, 1.0 * kRecordsAtOnce));
}

/// Seldom another number for a few more rays.
std::size_t wanted_samples(std::size_t rays) {
    const double wanted = kSamplesPerRoot * std::sqrt(static_cast<double>(rays));
    return std::max(std::bit_floor(static_cast<std::size_t>(wanted)), kLeastSamples);
}

}  // namespace

RecordGatherer::Shader::Shader(const RecordGatherer& gatherer)
    : surfaces(*gatherer.scene_, gatherer.lighting_->materials, gatherer.paths_),
      lighting(*gatherer.lighting_, gatherer.scene_->rays(), gatherer.paths_.transparent_bounces, *gatherer.parts_,
               kFaceErrors),
      hits(gatherer.lighting_->lobe_stride, *gatherer.parts_) {}

RecordGatherer::RecordGatherer(const CompiledScene& scene, const LightingScene& lighting, const PathSettings& paths,
                               bool shadows, LightCells& cells, const LightParts& parts, double spread)
    : scene_(&scene),
      lighting_(&lighting),
      paths_(paths),
      known_(&cells),
      parts_(&parts),
      light_count_(paths.max_bounces * paths.stored->parts),
      shadow_rays_(shadows ? 1 : 0),
      spread_(spread),
      darkness_(light_count_, Rgb(0)),
      shaders_([this] { return Shader(*this); }) {}

void RecordGatherer::gather(std::span<const Place> places, std::size_t rays_across, std::uint32_t seed, int threads,
                            const Stopped& stopped, const std::function<double()>& seconds_left,
                            std::vector<LightRecord>& made, RenderReport& report) {
    rays_per_record_ = rays_across * rays_across;
    seed_ = seed;
    const double start = seconds_left();
    for (std::size_t first = 0; first < places.size() && seconds_left() > 0; first += records_.size()) {
        const std::size_t count = std::min(records_at_once(first, start, seconds_left()), places.size() - first);
        records_.assign(count, {});
        places_ = places.subspan(first, count);
        distances_.assign(count * rays_per_record_, std::numeric_limits<double>::infinity());
        parallel_for(count, threads, [&](std::size_t i) {
            end_if(stopped);
            const Place& place = places_[i];
            const auto own_seed = seed_of(place.cell);
            records_[i] = RecordRays(place.surface, rays_across, own_seed);
            meet(i, own_seed, shaders_.local());
        });
        find_cells();
        shaded_light_.resize(shaded_.size() * light_count_);
        parallel_for((shaded_.size() + kShadedAtOnce - 1) / kShadedAtOnce, threads, [&](std::size_t i) {
            end_if(stopped);
            shade(i * kShadedAtOnce, shaders_.local());
        });
        for (const Cell& cell : cells_) {
            add(cell);
        }
        std::vector<LightRecord> finished(count);
        light_.assign(distances_.size(), darkness_.data());
        parallel_for((cells_.size() + kCellsAtOnce - 1) / kCellsAtOnce, threads, [&](std::size_t i) {
            for (std::size_t c = i * kCellsAtOnce; c < std::min((i + 1) * kCellsAtOnce, cells_.size()); ++c) {
                spread(cells_[c]);
            }
        });
        parallel_for(count, threads, [&](std::size_t i) {
            const std::size_t rays = i * rays_per_record_;
            finished[i] = records_[i].record(std::span(distances_).subspan(rays, rays_per_record_),
                                             std::span(light_).subspan(rays, rays_per_record_), light_count_,
                                             paths_.stored->parts, places_[i].reach);
            finished[i].cell = places_[i].cell;
        });
        std::ranges::move(finished, std::back_inserter(made));
    }
    for (Shader& shader : shaders_) {
        report += std::exchange(shader.report, {});
    }
}

void RecordGatherer::meet(std::size_t record, std::uint32_t seed, Shader& shader) {
    const std::span<const Ray> rays = records_[record].rays();
    shader.met.resize(rays.size());
    scene_->rays().intersect(rays, shader.met);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const RayHit& hit = shader.met[i];
        if (!rays[i].empty() && !hit.missed()) {
            const std::size_t number = record * rays_per_record_ + i;
            distances_[number] = std::max(double{hit.distance}, 1e-12);
            End end = {{}, hash(seed, static_cast<std::uint32_t>(i)), static_cast<std::uint32_t>(number), false};
            const SurfacePoint point = scene_->placed().surface(hit, rays[i].direction);
            end.is_own = !known_->find(point, rays[i].direction, distances_[number], end.cell);
            shader.ends.push_back(end);
        }
    }
}

void RecordGatherer::find_cells() {
    ends_.clear();
    for (Shader& shader : shaders_) {
        ends_.insert(ends_.end(), shader.ends.begin(), shader.ends.end());
        shader.ends.clear();
    }
    tbb::parallel_sort(ends_.begin(), ends_.end(), [](const End& a, const End& b) { return a.order() < b.order(); });
    cells_.clear();
    shaded_.clear();
    bool was_own = false;
    for (std::size_t first = 0; first < ends_.size();) {
        std::size_t last = first + 1;
        while (last < ends_.size() && ends_[last].cell == ends_[first].cell && !ends_[first].is_own) {
            ++last;
        }
        const bool is_own = ends_[first].is_own;
        const LightCells::Known known = is_own ? LightCells::Known() : known_->known(ends_[first].cell);
        const std::size_t wanted = is_own ? 1 : wanted_samples(known.rays + last - first);
        const std::size_t shaded = std::min(wanted - std::min(known.samples, wanted), last - first);
        if (!is_own || !was_own) {
            fill_group();
        }
        was_own = is_own;
        cells_.push_back({first, last - first, shaded_.size(), shaded});
        for (std::size_t i = 0; i < shaded; ++i) {
            shaded_.push_back({static_cast<std::uint32_t>(first + i), static_cast<std::uint32_t>(known.samples + i)});
        }
        first = last;
    }
    fill_group();
}

void RecordGatherer::fill_group() {
    shaded_.resize((shaded_.size() + kGroupRays - 1) / kGroupRays * kGroupRays, {kNone, 0});
}

Ray RecordGatherer::ray_of(const Shaded& shaded) const {
    if (shaded.end == kNone) {
        return {Vec3f(0), 0, Vec3f(0), -1};
    }
    const std::size_t ray = ends_[shaded.end].ray;
    return records_[ray / rays_per_record_].rays()[ray % rays_per_record_];
}

/// Shades some groups, from the ray `first` on.
void RecordGatherer::shade(std::size_t first, Shader& shader) {
    const std::size_t count = std::min(kShadedAtOnce, shaded_.size() - first);
    shader.rays.clear();
    shader.neighbours.clear();
    shader.seeds.clear();
    for (std::size_t i = 0; i < count; ++i) {
        const Shaded& shaded = shaded_[first + i];
        if (i % kGroupRays == 0) {
            const End& end = ends_[shaded.end];
            shader.seeds.push_back(end.is_own ? end.rank : hash(seed_of(end.cell), shaded.number));
        }
        shader.rays.push_back({ray_of(shaded), static_cast<std::uint32_t>(i % kGroupRays), shader.seeds.back()});
        const double pixel = shaded.end == kNone ? 0.0 : places_[ends_[shaded.end].ray / rays_per_record_].pixel;
        shader.neighbours.push_back({{}, {}, pixel, spread_});
    }
    shader.surfaces.trace_scattered(shader.rays, shader.neighbours, kGroupRays, shader.hits, shader.light);
    shader.penumbrae.assign(shader.seeds.size(), LightBits::kAll);
    shader.lighting.add(shader.seeds, shader.penumbrae, {0, kGroupRays, shadow_rays_, 0}, shader.hits, shader.report);
    for (std::size_t hit = 0; hit < shader.hits.size(); ++hit) {
        shader.light[shader.hits.in_apart[hit]].radiance += shader.hits.radiance[hit];
    }
    const std::size_t parts = paths_.stored->parts;
    Rgb* light = shaded_light_.data() + first * light_count_;
    for (std::size_t i = 0; i < count * paths_.max_bounces; ++i, light += parts) {
        const float kept = paths_.kept(kReflectance * shader.light[i].radiance);
        light[0] = kept * shader.light[i].radiance;
        for (std::uint32_t group = 0; group + 1 < parts; ++group) {
            light[1 + group] = kept * shader.hits.apart.of(i)[LightParts::of_group(group)];
        }
        if (parts > 1) {  // lights that share shadow rays tell their groups apart only for all of these rays
            complete({light + 1, parts - 1}, light[0], parts - 2);
        }
    }
}

/// A cell's light is the mean of that of some of its rays.
void RecordGatherer::add(const Cell& cell) {
    const End& end = ends_[cell.first];
    if (end.is_own) {
        return;
    }
    std::vector<Rgb> mean(light_count_, Rgb(0));
    for (std::size_t i = 0; i < cell.shaded * light_count_; ++i) {
        mean[i % light_count_] += shaded_light_[cell.first_shaded * light_count_ + i] / static_cast<float>(cell.shaded);
    }
    known_->add(end.cell, mean, {cell.shaded, cell.count});
}

/// Gives all rays of a cell its light.
void RecordGatherer::spread(const Cell& cell) {
    const End& first = ends_[cell.first];
    const Rgb* light =
        first.is_own ? shaded_light_.data() + cell.first_shaded * light_count_ : known_->look_up(first.cell).data();
    for (std::size_t end = cell.first; end < cell.first + cell.count; ++end) {
        light_[ends_[end].ray] = light;
    }
}

}  // namespace shlight
