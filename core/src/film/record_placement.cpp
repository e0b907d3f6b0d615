// SPDX-License-Identifier: MIT
#include "film/record_placement.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <glm/exponential.hpp>

#include "shlight/sampling.h"

namespace shlight {
namespace {

/// Radius of a record ÷ the harmonic mean of the distances around it, at most.
constexpr double kReach = 0.5;
/// Radius of a record ÷ the distance to the next one on its grid.
constexpr double kLeastSteps = 0.75;
constexpr double kMostSteps = 2.5;
/// Radius of a record that was found wrong farther away ÷ the width of a pixel, at least.
constexpr double kLeastPixels = 1.5;
/// Least cosine of the view by which a pixel's width grows on a surface.
constexpr double kLeastView = 0.1;
/// Weight of records, at most 1 each, of which a surface has enough.
constexpr float kEnough = 0.05F;
/// On grids below this step, only surfaces that have not enough get a record.
constexpr int kLeastRefined = 4;
/// On grids of this step and above, all surfaces get one: a few records may agree because none has seen a small light,
/// as a lamp in a mirror.
constexpr int kLeastWhole = 16;
/// Rays of a record along each side of the square of its directions, at the usual noise threshold; with less noise to
/// be seen it takes more.
constexpr double kRaysAcross = 20;
constexpr double kUsualThreshold = 0.01;
/// The threshold of a picture whose own is less.
constexpr double kLeastThreshold = 1e-3;
/// Differences between records that their noise explains are no error.
constexpr float kNoiseVariances = 4;

double mean(const Rgb& color, const Rgb& scale) {
    return (double{color.x / scale.x} + double{color.y / scale.y} + double{color.z / scale.z}) / 3;
}

Rgb color_of(std::span<const float> image, std::size_t pixel) {
    return {image[4 * pixel], image[4 * pixel + 1], image[4 * pixel + 2]};
}

std::size_t rays_across(double threshold) {
    const double least = kRaysAcross * std::sqrt(std::max(kUsualThreshold / threshold, 1.0));
    return static_cast<std::size_t>(std::ceil(least));
}

/// Any part of the picture then has some of those that are made at once.
template <class Wanted>
std::vector<Wanted> spread_over_picture(std::vector<Wanted> wanted) {
    const std::size_t step = (wanted.size() + kRecordsAtOnce - 1) / kRecordsAtOnce;
    std::vector<Wanted> spread;
    spread.reserve(wanted.size());
    for (std::size_t first = 0; first < step; ++first) {
        for (std::size_t i = first; i < wanted.size(); i += step) {
            spread.push_back(wanted[i]);
        }
    }
    return spread;
}

}  // namespace

RecordPlacement::Finder::Finder(const Picture& picture, const PathSettings& paths)
    : surfaces(*picture.scene, picture.lighting.materials, paths), hits(picture.lighting.lobe_stride) {}

RecordPlacement::RecordPlacement(const Picture& picture, std::span<const float> image, StoredLight& stored)
    : picture_(&picture),
      image_(image),
      stored_(&stored),
      paths_(picture.paths(&stored)),
      threshold_(std::max(picture.settings.sampling.noise_threshold, kLeastThreshold)),
      finders_([this] {
          PathSettings seen = paths_;
          seen.scatters = false;
          return Finder(*picture_, seen);
      }),
      gatherer_(*picture.scene, picture.lighting, paths_, picture.settings.shadow_rays > 0, stored.cells,
                stored.parts > 1 ? picture.parts : kWholeLight) {
    double sum = 0;
    for (std::size_t i = 0; i < image.size() / 4; ++i) {
        sum += mean(color_of(image, i), Rgb(1));
    }
    const double average = 4 * sum / static_cast<double>(image.size());
    least_square_ = 0.01 * average * average;
}

RenderReport RecordPlacement::add_grid(const Grid& grid, const Stopped& stopped,
                                       const std::function<bool()>& has_time) {
    const int threads = picture_->settings.threads;
    std::vector<Row> rows(static_cast<std::size_t>((picture_->height + grid.step - 1) / grid.step));
    parallel_for(rows.size(), threads, [&](std::size_t row) {
        end_if(stopped);
        rows[row] = find(static_cast<int>(row) * grid.step, grid, finders_.local());
    });
    std::vector<Wanted> wanted;
    double errors = 0;
    std::size_t pixels = 0;
    for (const Row& row : rows) {
        wanted.insert(wanted.end(), row.wanted.begin(), row.wanted.end());
        errors += row.errors;
        pixels += row.pixels;
    }
    error_ = std::sqrt(errors / static_cast<double>(std::max<std::size_t>(pixels, 1)));
    wanted = spread_over_picture(std::move(wanted));
    std::vector<SurfacePoint> surfaces;
    std::ranges::transform(wanted, std::back_inserter(surfaces), &Wanted::point);
    const auto seed = hash(picture_->settings.seed, static_cast<std::uint32_t>(stored_->records.all().size()));
    RenderReport report;
    auto made = gatherer_.gather(surfaces, rays_across(threshold_), seed, threads, stopped, has_time, report);
    wanted.resize(made.size());
    for (std::size_t i = 0; i < made.size(); ++i) {
        made[i].limit_radius(kReach * made[i].radius, kLeastSteps * wanted[i].to_next, kMostSteps * wanted[i].to_next);
        stored_->records.add(std::move(made[i]));
    }
    stored_->records.index();
    shrink_wrong(wanted);
    return report;
}

RecordPlacement::Row RecordPlacement::find(int row, const Grid& grid, Finder& finder) const {
    finder.rays.clear();
    finder.pixels.clear();
    for (int column = 0; column < picture_->width; column += grid.step) {
        if (grid.wider == 0 || row % grid.wider != 0 || column % grid.wider != 0) {
            const auto seed = hash(static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(row));
            finder.rays.push_back({picture_->ray(column + 0.5, row + 0.5, {}), 0, seed});
            finder.pixels.push_back(static_cast<std::size_t>(row) * static_cast<std::size_t>(picture_->width) +
                                    static_cast<std::size_t>(column));
        }
    }
    Row found;
    found.pixels = finder.rays.size();
    if (found.pixels > 0) {
        finder.surfaces.trace(finder.rays, {}, 1, finder.hits, finder.light);
        for (const CameraSurfaces::Surface& surface : finder.surfaces.surfaces()) {
            if (surface.sees_lights() && surface.bounces < paths_.max_bounces &&
                surface.depth <= paths_.transparent_bounces) {
                look_at(surface, grid.step, finder, found);
            }
        }
    }
    return found;
}

void RecordPlacement::look_at(const CameraSurfaces::Surface& surface, int step, Finder& finder, Row& row) const {
    finder.surfaces.find_lobes(surface, finder.lobes);
    Rgb albedo(0);
    for (const SurfaceLobe& lobe : finder.lobes) {
        albedo += is_glossy(lobe.shape) || lobe.translucent ? Rgb(0) : glm::abs(lobe.weight * surface.throughput);
    }
    if (albedo == Rgb(0)) {
        return;
    }
    const RecordedLight found =
        stored_->records.look_up(surface.point, (paths_.max_bounces - surface.bounces - 1) * stored_->parts);
    const Rgb all = color_of(image_, finder.pixels[surface.ray]) + albedo * found.mean;
    const Rgb scale = glm::sqrt(all * all + static_cast<float>(least_square_)) / glm::max(albedo, Rgb(1e-6F));
    const double error = mean(found.variance + found.noise, scale * scale);
    row.errors += found.weight > 0 ? error : 0.0;
    const bool is_exact = step < kLeastRefined || (step < kLeastWhole && error <= threshold_ * threshold_);
    if (found.weight >= kEnough && is_exact) {
        return;
    }
    const double width = picture_->pixel_width(surface.ray_length());
    const double cosine = std::max(glm::dot(surface.point.geometric_normal, surface.towards_viewer), kLeastView);
    const double to_next = step * width / std::sqrt(cosine);
    row.wanted.push_back({surface.point, width, to_next, static_cast<float>(threshold_) * scale});
}

void RecordPlacement::shrink_wrong(std::span<const Wanted> wanted) {
    const std::span<const LightRecord> all = stored_->records.all();
    const std::size_t first = all.size() - wanted.size();
    const std::size_t whole = (paths_.max_bounces - 1) * stored_->parts;
    std::vector<double> radius(all.size());
    std::transform(all.begin(), all.end(), radius.begin(), [](const LightRecord& record) { return record.radius; });
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        const LightRecord& own = all[first + i];
        const RecordBasis basis = reflected_basis(own.normal);
        stored_->records.for_each_near(wanted[i].point, [&](std::size_t number, const LightRecord& other, float) {
            const Rgb difference = sum_of(other.light[whole], basis) - own.reflected[whole];
            const Rgb noise = own.noise * own.noise + other.noise * other.noise;
            const Rgb allowed = wanted[i].allowed * wanted[i].allowed + kNoiseVariances * noise;
            if (number != first + i && mean(difference * difference, allowed) > 1) {
                const double distance = glm::distance(own.position, other.position);
                radius[number] = std::min(radius[number], std::max(distance, kLeastPixels * wanted[i].pixel));
            }
        });
    }
    for (std::size_t i = 0; i < radius.size(); ++i) {
        stored_->records.shrink(i, radius[i]);
    }
    stored_->records.index();
}

}  // namespace shlight
