// SPDX-License-Identifier: MIT
#include "film/record_gatherer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/perpendicular.h"
#include "shlight/basis.h"
#include "shlight/sampling.h"
#include "tracing/light_bits.h"

namespace shlight {
namespace {

constexpr std::size_t kGroupRays = kGroupAcross * kGroupAcross;
/// Share of rays that are drawn evenly over the half space; the others are drawn as its cosine.
constexpr double kEven = 0.25;
/// Cosine below which rays go along the surface.
constexpr double kAlongSurface = 0.3;

/// The cosine below which a share u of the rays lies, which have the density kEven + 2 (1 - kEven) μ.
double cosine_of(double u) {
    return (std::sqrt(kEven * kEven + 4 * (1 - kEven) * u) - kEven) / (2 * (1 - kEven));
}

}  // namespace

RecordGatherer::RecordGatherer(const CompiledScene& scene, const LightingScene& lighting, const PathSettings& paths,
                               bool shadows)
    : max_bounces_(paths.max_bounces),
      shadow_rays_(shadows ? 1 : 0),
      surfaces_(scene, lighting.materials, paths),
      lighting_(lighting, scene.rays(), paths.transparent_bounces, kWholeLight),
      hits_(lighting.lobe_stride) {}

/// One ray in each cell of a grid over the square that directions are made of; groups of cells follow each other.
void RecordGatherer::aim(const SurfacePoint& surface, std::size_t rays_across, std::uint32_t seed) {
    rays_.clear();
    directions_.clear();
    const Vec3d& z = surface.shading_normal;
    x_ = perpendicular(z);
    y_ = glm::cross(z, x_);
    by_cell_.resize(rays_across * rays_across);
    const SobolSequence jitter(seed);
    const auto across = static_cast<double>(rays_across);
    for (std::size_t group = 0; group < rays_across * rays_across / kGroupRays; ++group) {
        const std::size_t groups_across = rays_across / kGroupAcross;
        for (std::size_t i = 0; i < kGroupRays; ++i) {
            const std::size_t row = group / groups_across * kGroupAcross + i / kGroupAcross;
            const std::size_t column = group % groups_across * kGroupAcross + i % kGroupAcross;
            by_cell_[row * rays_across + column] = rays_.size();
            const glm::dvec2 inside = jitter.point(static_cast<std::uint32_t>(rays_.size()));
            const double cosine = cosine_of((static_cast<double>(row) + inside.x) / across);
            const double sine = std::sqrt(std::max(1 - cosine * cosine, 0.0));
            const double azimuth = 2 * std::numbers::pi * (static_cast<double>(column) + inside.y) / across;
            const Vec3d way = sine * std::cos(azimuth) * x_ + sine * std::sin(azimuth) * y_ + cosine * z;
            const double density = (kEven + 2 * (1 - kEven) * cosine) / (2 * std::numbers::pi);
            const bool leaves = glm::dot(way, surface.geometric_normal) > 0;
            const Ray ray = leaves ? Ray{Vec3f(surface.off_surface()), 0, Vec3f(way)} : Ray{};
            rays_.push_back({ray, static_cast<std::uint32_t>(i), hash(seed, static_cast<std::uint32_t>(group))});
            directions_.push_back({way, static_cast<float>(1 / (density * across * across))});
        }
    }
}

void RecordGatherer::shade(std::uint32_t seed, RenderReport& report) {
    surfaces_.trace_scattered(rays_, kGroupRays, hits_, light_);
    seeds_.clear();
    for (std::size_t group = 0; group < hits_.pixel_count(); ++group) {
        seeds_.push_back(hash(seed, static_cast<std::uint32_t>(group)));
    }
    penumbrae_.assign(seeds_.size(), LightBits::kAll);
    lighting_.add(seeds_, penumbrae_, {0, kGroupRays, shadow_rays_, 0}, hits_, report);
    std::size_t hit = 0;
    for (std::size_t group = 0; group < hits_.pixel_count(); ++group) {
        for (; hit < hits_.pixel_begin[group + 1]; ++hit) {
            const std::size_t ray = group * kGroupRays + hits_.sample[hit];
            light_[ray * max_bounces_ + surfaces_.bounces_of_hits()[hit] - 1].radiance += hits_.radiance[hit];
        }
    }
}

void RecordGatherer::find_distances() {
    distances_.assign(rays_.size(), std::numeric_limits<double>::infinity());
    for (const CameraSurfaces::Surface& surface : surfaces_.surfaces()) {
        if (surface.bounces == 1 && surface.depth == 0) {
            distances_[surface.ray] = std::max(surface.distance, 1e-12);
        }
    }
}

double RecordGatherer::mean_distance() const {
    double nearness = 0;
    for (std::size_t ray = 0; ray < rays_.size(); ++ray) {
        nearness += directions_[ray].solid_angle / distances_[ray];
    }
    return 2 * std::numbers::pi / nearness;
}

/// Rays close to the horizon meet what stands on the surface.
void RecordGatherer::find_free(LightRecord& record) const {
    record.free.fill(std::numeric_limits<float>::infinity());
    for (std::size_t ray = 0; ray < rays_.size(); ++ray) {
        const Vec3d& way = directions_[ray].way;
        const double cosine = glm::dot(way, record.normal);
        if (cosine < kAlongSurface) {
            float& free = record.free[record.sector(way)];
            free = std::min(free, static_cast<float>(distances_[ray] * std::sqrt(1 - cosine * cosine)));
        }
    }
}

void RecordGatherer::find_gradients(std::size_t rays_across, LightRecord& record) const {
    const auto across = static_cast<double>(rays_across);
    record.gradient.assign(max_bounces_, {Rgb(0), Rgb(0), Rgb(0)});
    const auto add = [&](std::size_t cell, std::size_t before, const Vec3d& way, double factor) {
        const std::size_t one = by_cell_[cell];
        const std::size_t other = by_cell_[before];
        const double rate = factor / std::min(distances_[one], distances_[other]) / std::numbers::pi;
        Rgb difference(0);
        for (std::size_t k = 0; k < max_bounces_ && rate != 0; ++k) {
            difference += light_[one * max_bounces_ + k].radiance - light_[other * max_bounces_ + k].radiance;
            for (int axis = 0; axis < 3; ++axis) {
                record.gradient[k][static_cast<std::size_t>(axis)] += static_cast<float>(rate * way[axis]) * difference;
            }
        }
    };
    const auto direction = [&](double column) {
        const double azimuth = 2 * std::numbers::pi * column / across;
        return std::cos(azimuth) * x_ + std::sin(azimuth) * y_;
    };
    for (std::size_t row = 0; row < rays_across; ++row) {
        const double low = cosine_of(static_cast<double>(row) / across);
        const double high = cosine_of(static_cast<double>(row + 1) / across);
        const double sine_low = std::sqrt(1 - low * low);
        const double sine_high = std::sqrt(std::max(1 - high * high, 0.0));
        for (std::size_t column = 0; column < rays_across; ++column) {
            const std::size_t cell = row * rays_across + column;
            const auto place = static_cast<double>(column);
            if (row > 0) {
                add(cell, cell - rays_across, direction(place + 0.5),
                    -2 * std::numbers::pi / across * sine_low * low * low);
            }
            const std::size_t beside = row * rays_across + (column + rays_across - 1) % rays_across;
            add(cell, beside, direction(place + across / 4), sine_low - sine_high);
        }
    }
}

void RecordGatherer::add_up(std::size_t rays_across, LightRecord& record) const {
    record.light.assign(max_bounces_, {});
    std::array<Rgb, 2> halves = {};  // of what a white diffuse surface reflects, by cells in turn
    for (std::size_t cell = 0; cell < by_cell_.size(); ++cell) {
        const std::size_t ray = by_cell_[cell];
        RecordBasis basis;
        const Vec3f way(directions_[ray].way);
        sh_basis(std::span<const Vec3f>(&way, 1), kRecordOrder, std::span<float>(basis));
        Rgb sum(0);
        for (std::size_t k = 0; k < max_bounces_; ++k) {
            sum += directions_[ray].solid_angle * light_[ray * max_bounces_ + k].radiance;
            for (std::size_t i = 0; i < kRecordTerms; ++i) {
                record.light[k][i] += glm::vec4(sum, 0) * basis[i];
            }
        }
        const double cosine = std::max(glm::dot(directions_[ray].way, record.normal), 0.0);
        halves[(cell / rays_across + cell) % 2] += sum * static_cast<float>(cosine / std::numbers::pi);
    }
    record.noise = glm::abs(halves[0] - halves[1]);
    const RecordBasis reflecting = reflected_basis(record.normal);
    for (const RecordHarmonics& light : record.light) {
        record.reflected.push_back(sum_of(light, reflecting));
    }
}

LightRecord RecordGatherer::gather(const SurfacePoint& surface, std::size_t rays_across, std::uint32_t seed,
                                   RenderReport& report) {
    aim(surface, rays_across, seed);
    shade(seed, report);
    find_distances();
    LightRecord record;
    record.position = surface.position;
    record.normal = surface.shading_normal;
    record.along = x_;
    record.across = y_;
    record.radius = mean_distance();
    find_free(record);
    add_up(rays_across, record);
    find_gradients(rays_across, record);
    return record;
}

}  // namespace shlight
