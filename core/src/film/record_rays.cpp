// SPDX-License-Identifier: MIT
#include "film/record_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/perpendicular.h"
#include "shlight/basis.h"
#include "shlight/sampling.h"

namespace shlight {
namespace {

/// Share of rays that are drawn evenly over the half space; the others are drawn as its cosine.
constexpr double kEven = 0.25;
/// Cosine below which rays go along the surface.
constexpr double kAlongSurface = 0.3;

/// The cosine below which a share u of the rays lies, which have the density kEven + 2 (1 - kEven) μ.
double cosine_of(double u) {
    return (std::sqrt(kEven * kEven + 4 * (1 - kEven) * u) - kEven) / (2 * (1 - kEven));
}

double mean_distance(std::span<const double> distances, std::span<const float> solid_angles) {
    double nearness = 0;
    for (std::size_t ray = 0; ray < distances.size(); ++ray) {
        nearness += solid_angles[ray] / distances[ray];
    }
    return 2 * std::numbers::pi / nearness;
}

}  // namespace

RecordRays::RecordRays(const SurfacePoint& surface, std::size_t across, std::uint32_t seed)
    : across_(across),
      position_(surface.position),
      x_(perpendicular(surface.shading_normal)),
      z_(surface.shading_normal) {
    y_ = glm::cross(z_, x_);
    const SobolSequence jitter(seed);
    const auto width = static_cast<double>(across);
    for (std::size_t cell = 0; cell < across * across; ++cell) {
        const glm::dvec2 inside = jitter.point(static_cast<std::uint32_t>(cell));
        const std::size_t row = cell / across;
        const double cosine = cosine_of((static_cast<double>(row) + inside.x) / width);
        const double sine = std::sqrt(std::max(1 - cosine * cosine, 0.0));
        const double azimuth = 2 * std::numbers::pi * (static_cast<double>(cell % across) + inside.y) / width;
        const Vec3d way = sine * std::cos(azimuth) * x_ + sine * std::sin(azimuth) * y_ + cosine * z_;
        const double density = (kEven + 2 * (1 - kEven) * cosine) / (2 * std::numbers::pi);
        const bool leaves = glm::dot(way, surface.geometric_normal) > 0;
        rays_.push_back({Vec3f(surface.off_surface()), 0, Vec3f(way), leaves ? Ray().t_max : -1, kDiffuseRay});
        ways_.push_back(way);
        solid_angles_.push_back(static_cast<float>(1 / (density * width * width)));
    }
}

LightRecord RecordRays::record(std::span<const double> distances, std::span<const Rgb* const> light, std::size_t count,
                               std::size_t parts, double reach) const {
    LightRecord record;
    record.position = position_;
    record.normal = z_;
    record.along = x_;
    record.across = y_;
    record.radius = mean_distance(distances, solid_angles_);
    record.light.assign(count, {});
    record.gradient.assign(count, {Rgb(0), Rgb(0), Rgb(0)});
    find_free(distances, record);
    add_up(light, parts, record);
    find_gradients(distances, light, parts, reach, record);
    return record;
}

/// Rays close to the horizon meet what stands on the surface.
void RecordRays::find_free(std::span<const double> distances, LightRecord& record) const {
    record.free.fill(std::numeric_limits<float>::infinity());
    for (std::size_t ray = 0; ray < ways_.size(); ++ray) {
        const double cosine = glm::dot(ways_[ray], z_);
        if (cosine < kAlongSurface) {
            float& free = record.free[record.sector(ways_[ray])];
            free = std::min(free, static_cast<float>(distances[ray] * std::sqrt(1 - cosine * cosine)));
        }
    }
}

void RecordRays::find_gradients(std::span<const double> distances, std::span<const Rgb* const> light, std::size_t parts,
                                double reach, LightRecord& record) const {
    const auto across = static_cast<double>(across_);
    const std::size_t count = record.gradient.size();
    const auto add = [&](std::size_t one, std::size_t other, const Vec3d& way, double factor) {
        const double rate = factor / std::max(std::min(distances[one], distances[other]), reach) / std::numbers::pi;
        for (std::size_t part = 0; part < parts && rate != 0; ++part) {
            Rgb difference(0);
            for (std::size_t k = part; k < count; k += parts) {
                difference += light[one][k] - light[other][k];
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    record.gradient[k][axis] += static_cast<float>(rate * way[static_cast<int>(axis)]) * difference;
                }
            }
        }
    };
    const auto direction = [&](double column) {
        const double azimuth = 2 * std::numbers::pi * column / across;
        return std::cos(azimuth) * x_ + std::sin(azimuth) * y_;
    };
    for (std::size_t row = 0; row < across_; ++row) {
        const double low = cosine_of(static_cast<double>(row) / across);
        const double high = cosine_of(static_cast<double>(row + 1) / across);
        const double sine_low = std::sqrt(1 - low * low);
        const double sine_high = std::sqrt(std::max(1 - high * high, 0.0));
        for (std::size_t column = 0; column < across_; ++column) {
            const std::size_t cell = row * across_ + column;
            const auto place = static_cast<double>(column);
            if (row > 0) {
                add(cell, cell - across_, direction(place + 0.5),
                    -2 * std::numbers::pi / across * sine_low * low * low);
            }
            const std::size_t beside = row * across_ + (column + across_ - 1) % across_;
            add(cell, beside, direction(place + across / 4), sine_low - sine_high);
        }
    }
}

void RecordRays::add_up(std::span<const Rgb* const> light, std::size_t parts, LightRecord& record) const {
    const std::size_t count = record.light.size();
    const std::vector<Vec3f> ways(ways_.begin(), ways_.end());
    std::vector<float> bases(ways.size() * kRecordTerms);
    sh_basis(std::span<const Vec3f>(ways), kRecordOrder, std::span<float>(bases));
    std::vector<Rgb> sums;         // of parts
    std::array<Rgb, 2> pair = {};  // what a white diffuse surface reflects of two rays side by side
    Rgb variance(0);
    for (std::size_t ray = 0; ray < ways_.size(); ++ray) {
        const float* basis = &bases[ray * kRecordTerms];
        sums.assign(parts, Rgb(0));
        for (std::size_t k = 0; k < count; ++k) {
            Rgb& sum = sums[k % parts];
            sum += solid_angles_[ray] * light[ray][k];
            for (std::size_t i = 0; i < kRecordTerms; ++i) {
                record.light[k][i] += glm::vec4(sum, 0) * basis[i];
            }
        }
        const double cosine = std::max(glm::dot(ways_[ray], z_), 0.0);
        pair[ray % 2] = sums[0] * static_cast<float>(cosine / std::numbers::pi);
        variance += ray % 2 == 1 ? (pair[0] - pair[1]) * (pair[0] - pair[1]) : Rgb(0);
    }
    record.noise = glm::sqrt(variance);
    const RecordBasis reflecting = reflected_basis(z_);
    for (const RecordHarmonics& harmonics : record.light) {
        record.reflected.push_back(sum_of(harmonics, reflecting));
    }
}

}  // namespace shlight
