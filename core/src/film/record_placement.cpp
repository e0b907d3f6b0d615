// SPDX-License-Identifier: MIT
#include "film/record_placement.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>
#include <unordered_set>
#include <utility>

#include <glm/exponential.hpp>

#include "lighting/ray_sums.h"
#include "shlight/sampling.h"

namespace shlight {
namespace {

/// Radius of a record ÷ the harmonic mean of the distances around it, at most.
constexpr double kReach = 0.5;
/// Radius of a record ÷ the edge of its cell.
constexpr double kLeastSteps = 0.75;
constexpr double kMostSteps = 2.5;
/// The share of what a picture shows at a record that its noise may be. A record with more reaches as many times as
/// far, up to kMostSpread times: one of its rays has met a small bright place, and the surface around shares its light.
constexpr double kPlainNoise = 0.15;
constexpr double kMostSpread = 3;
/// RecordRays::record()'s reach ÷ the edge of the record's cell.
constexpr double kGradientSteps = 1.5;
/// Radius of a record that was found wrong farther away ÷ the width of a pixel, at least.
constexpr double kLeastPixels = 1.5;
/// Least cosine of the view by which a pixel's width grows on a surface.
constexpr double kLeastView = 0.1;
/// Weight of records, at most 1 each, of which a surface has enough.
constexpr float kEnough = 0.05F;
/// In cells below so many pixels, only surfaces that have not enough get a record.
constexpr int kLeastRefined = 4;
/// In cells of so many pixels and more, all surfaces get one: a few records may agree because none has seen a small
/// light, as a lamp in a mirror.
constexpr int kLeastWhole = 16;
/// Pixels across a cell that are looked at, and pixels from one of them to the next, at least.
constexpr int kPixelsPerCell = 2;
constexpr int kLeastBetween = 2;
/// Places in a cell that a record may have.
constexpr std::uint32_t kTrials = 8;
/// Rays of a record along each side of the square of its directions, at the usual noise threshold; with less noise to
/// be seen it takes more.
constexpr double kRaysAcross = 20;
constexpr double kUsualThreshold = 0.01;
/// The threshold of a picture whose own is less.
constexpr double kLeastThreshold = 1e-3;
/// Differences between records that their noise explains are no error.
constexpr double kNoiseVariances = 4;

Vec3d color_of(std::span<const float> image, std::size_t pixel) {
    return {image[4 * pixel], image[4 * pixel + 1], image[4 * pixel + 2]};
}

std::size_t rays_across(double threshold) {
    const double least = kRaysAcross * std::sqrt(std::max(kUsualThreshold / threshold, 1.0));
    return static_cast<std::size_t>(std::ceil(least));
}

/// Random bits by which cells are ordered.
std::size_t rank(const WorldCell& cell) {
    return WorldCellHash()(cell);
}

}  // namespace

RecordPlacement::Finder::Finder(const Picture& picture, const PathSettings& paths)
    : surfaces(*picture.scene, picture.lighting.materials, paths), hits(picture.lighting.lobe_stride) {}

RecordPlacement::RecordPlacement(const Picture& picture, std::span<const float> image, bool has_bounced,
                                 StoredLight& stored)
    : picture_(&picture),
      image_(image),
      has_bounced_(has_bounced),
      stored_(&stored),
      paths_(picture.paths(&stored)),
      lattice_(*picture.scene),
      threshold_(std::max(picture.settings.sampling.noise_threshold, kLeastThreshold)),
      finders_([this] {
          PathSettings seen = paths_;
          seen.scatters = false;
          return Finder(*picture_, seen);
      }),
      gatherer_(*picture.scene, picture.lighting_of_records(), paths_, picture.settings.shadow_rays > 0, stored.cells,
                stored.parts > 1 ? picture.parts : kWholeLight, picture.pixel_width(1) - picture.pixel_width(0)) {
    stored.records.begin_picture();
    double sum = 0;
    for (std::size_t i = 0; i < image.size() / 4; ++i) {
        sum += mean(color_of(image, i));
    }
    const double average = 4 * sum / static_cast<double>(image.size());
    least_square_ = 0.01 * average * average;
}

RenderReport RecordPlacement::add_grid(int step, const Stopped& stopped, const std::function<double()>& seconds_left) {
    const int threads = picture_->settings.threads;
    const int between = std::max(step / kPixelsPerCell, kLeastBetween);
    std::vector<Row> rows(static_cast<std::size_t>((picture_->height + between - 1) / between));
    parallel_for(rows.size(), threads, [&](std::size_t row) {
        end_if(stopped);
        rows[row] = find(static_cast<int>(row) * between, step, finders_.local());
    });
    std::vector<Seen> seen;
    double errors = 0;
    std::size_t pixels = 0;
    for (const Row& row : rows) {
        seen.insert(seen.end(), row.seen.begin(), row.seen.end());
        errors += row.errors;
        pixels += row.pixels;
    }
    error_ = std::sqrt(errors / static_cast<double>(std::max<std::size_t>(pixels, 1)));
    std::vector<Wanted> wanted = find_wanted(std::move(seen), step, stopped);
    const auto first_lacking = std::stable_partition(
        wanted.begin(), wanted.end(), [&](const Wanted& own) { return stored_->records.use(own.place.cell); });
    const std::span lacking(first_lacking, wanted.end());
    std::vector<RecordGatherer::Place> places;
    std::transform(lacking.begin(), lacking.end(), std::back_inserter(places),
                   [](const Wanted& own) { return own.place; });
    std::vector<LightRecord> made;
    RenderReport report;
    try {
        gatherer_.gather(places, rays_across(threshold_), picture_->settings.seed, threads, stopped, seconds_left, made,
                         report);
    } catch (const RenderCancelled&) {
        add(made, lacking);
        throw;
    }
    report.records = made.size();
    add(made, lacking);
    wanted.resize(wanted.size() - lacking.size() + made.size());
    stored_->records.index();
    shrink_wrong(wanted, step);
    return report;
}

void RecordPlacement::add(std::span<LightRecord> made, std::span<const Wanted> wanted) {
    for (std::size_t i = 0; i < made.size(); ++i) {
        const double noise = mean(quotient(Vec3d(made[i].noise), wanted[i].allowed)) * threshold_;
        const double spread = std::clamp(noise / kPlainNoise, 1.0, kMostSpread);
        const double edge = spread * std::ldexp(1.0, wanted[i].level);
        made[i].limit_radius(spread * kReach * made[i].radius, kLeastSteps * edge, kMostSteps * edge);
        stored_->records.add(std::move(made[i]));
    }
}

RecordPlacement::Row RecordPlacement::find(int row, int step, Finder& finder) const {
    finder.rays.clear();
    finder.pixels.clear();
    const int between = std::max(step / kPixelsPerCell, kLeastBetween);
    for (int column = 0; column < picture_->width; column += between) {
        const auto seed = hash(static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(row));
        finder.rays.push_back({picture_->ray(column + 0.5, row + 0.5, {}), 0, seed});
        finder.pixels.push_back(static_cast<std::size_t>(row) * static_cast<std::size_t>(picture_->width) +
                                static_cast<std::size_t>(column));
    }
    Row found;
    found.pixels = finder.rays.size();
    finder.surfaces.trace(finder.rays, {}, 1, finder.hits, finder.light);
    for (const CameraSurfaces::Surface& surface : finder.surfaces.surfaces()) {
        if (surface.sees_lights() && surface.cover == Cover::none && surface.bounces < paths_.max_bounces &&
            surface.depth <= paths_.transparent_bounces) {
            look_at(surface, step, finder, found);
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
    const std::size_t pixel = finder.pixels[surface.ray];
    const RecordedLight found = stored_->records.look_up(surface.point, number_of_all(surface.bounces));
    const Vec3d all = color_of(image_, pixel) + (has_bounced_ ? Vec3d(0) : Vec3d(albedo * found.mean));
    const Vec3d scale = glm::sqrt(all * all + least_square_) / Vec3d(glm::max(albedo, Rgb(1e-6F)));
    row.errors += found.weight > 0 ? mean(quotient(found.variance + found.noise, scale * scale)) : 0.0;
    if (found.weight >= kEnough && step < kLeastRefined) {
        return;
    }
    const double width = picture_->pixel_width(surface.ray_length());
    const double cosine = std::max(glm::dot(surface.point.geometric_normal, surface.towards_viewer), kLeastView);
    const double between = std::max(step * width / std::sqrt(cosine), surface.point.error);
    const int level = WorldLattice::level(between);
    row.seen.push_back(
        {lattice_.cell(surface.point, level), level, surface.point, width, surface.bounces, threshold_ * scale});
}

std::vector<RecordPlacement::Wanted> RecordPlacement::find_wanted(std::vector<Seen> seen, int step,
                                                                  const Stopped& stopped) {
    const auto order = [](const Seen& one) { return std::tuple(one.cell.place, one.cell.kind); };
    std::ranges::stable_sort(seen, {}, order);
    std::vector<std::span<const Seen>> cells;
    for (auto begin = seen.begin(); begin != seen.end();) {
        const auto end = std::ranges::upper_bound(begin, seen.end(), order(*begin), {}, order);
        cells.emplace_back(begin, end);
        begin = end;
    }
    std::vector<std::optional<Wanted>> found(cells.size());
    parallel_for(cells.size(), picture_->settings.threads, [&](std::size_t i) {
        end_if(stopped);
        found[i] = wanted(cells[i], step);
    });
    std::vector<Wanted> all;
    std::unordered_set<WorldCell, WorldCellHash> taken;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const std::optional<Wanted>& own = found[i];
        if (!own) {
            stored_->records.spare(cells[i].front().cell);
        } else if (!stored_->records.has(own->place.cell) && taken.insert(own->place.cell).second) {
            all.push_back(*own);
        }
    }
    std::ranges::sort(all, {}, [](const Wanted& own) { return rank(own.place.cell); });
    return all;
}

std::optional<RecordPlacement::Wanted> RecordPlacement::wanted(std::span<const Seen> seen, int step) const {
    const int level = seen.front().level;
    const Vec3d middle = lattice_.middle(seen.front().point, level);
    const Seen& nearest =
        *std::ranges::min_element(seen, {}, [&](const Seen& own) { return glm::distance(own.point.position, middle); });
    std::optional<SurfacePoint> found = lattice_.surface(nearest.point, level, glm::dvec2(0.5));
    const SobolSequence places(static_cast<std::uint32_t>(rank(nearest.cell)));
    for (std::uint32_t trial = 1; trial < kTrials && !found; ++trial) {
        found = lattice_.surface(nearest.point, level, places.point(trial));
    }
    const SurfacePoint point = found.value_or(nearest.point);
    const WorldCell cell = lattice_.cell(point, level);
    Vec3d allowed(0);
    for (const Seen& own : seen) {
        allowed += own.allowed / static_cast<double>(seen.size());
    }
    if (step >= kLeastRefined && step < kLeastWhole && !stored_->records.knows(cell)) {
        if (stored_->records.spares(seen.front().cell)) {
            return std::nullopt;
        }
        const RecordedLight light = stored_->records.look_up(point, number_of_all(nearest.bounces));
        if (light.weight >= kEnough && mean((light.variance + light.noise) / (allowed * allowed)) <= 1) {
            return std::nullopt;
        }
    }
    return Wanted{{point, cell, kGradientSteps * std::ldexp(1.0, level), nearest.pixel}, level, allowed};
}

void RecordPlacement::shrink_wrong(std::span<const Wanted> wanted, int step) {
    const std::span<const LightRecord> all = stored_->records.all();
    const std::size_t whole = number_of_all(0);
    std::vector<double> radius(all.size());
    std::transform(all.begin(), all.end(), radius.begin(), [](const LightRecord& record) { return record.radius; });
    for (const Wanted& one : wanted) {
        const std::size_t own_number = stored_->records.number_of(one.place.cell);
        const LightRecord& own = all[own_number];
        const RecordBasis basis = reflected_basis(own.normal);
        const double least = kLeastPixels / step * std::ldexp(1.0, one.level);
        stored_->records.for_each_near(one.place.surface, [&](std::size_t number, const LightRecord& other, float) {
            const Vec3d difference(sum_of(other.light[whole], basis) - own.reflected[whole]);
            const Vec3d noise = squared(own.noise) + squared(other.noise);
            const Vec3d allowed = one.allowed * one.allowed + kNoiseVariances * noise;
            if (number != own_number && mean(difference * difference / allowed) > 1) {
                const double distance = glm::distance(own.position, other.position);
                radius[number] = std::min(radius[number], std::max(distance, least));
            }
        });
    }
    for (std::size_t i = 0; i < radius.size(); ++i) {
        stored_->records.shrink(i, radius[i]);
    }
    stored_->records.index();
}

}  // namespace shlight
