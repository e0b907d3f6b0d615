// SPDX-License-Identifier: MIT
#include "film/pixel_batch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/stage_clock.h"
#include "shlight/sampling.h"

namespace shlight {
namespace {

/// Camera rays that tell a gradient from an edge.
constexpr std::uint32_t kLeastForPlane = 8;
/// Largest radiance of a camera ray; squares of brighter ones would overflow in float.
constexpr double kBrightestRay = 1e18;
/// Share of pixels without a ray that sees the environment, from which on rays to it are guided.
constexpr double kLeastHidden = 1.0 / 8;
/// Spacings of a guide's grid across the picture.
constexpr double kGuideSteps = 16;
/// Seed of points of the aperture.
constexpr std::uint32_t kLensSeed = 0xFFFFFFFCU;

/// The kind of each pass that is one.
constexpr std::array<std::pair<Pass, LightKind>, kLightKinds> kKindPasses = {
    std::pair(Pass::diffuse_direct, LightKind::diffuse),
    std::pair(Pass::glossy_direct, LightKind::glossy),
    std::pair(Pass::transmission_direct, LightKind::transmission),
    std::pair(Pass::diffuse_indirect, LightKind::diffuse_indirect),
    std::pair(Pass::glossy_indirect, LightKind::glossy_indirect),
    std::pair(Pass::transmission_indirect, LightKind::transmission_indirect),
    std::pair(Pass::emission, LightKind::emission),
    std::pair(Pass::environment, LightKind::environment)};

float brightness(const Rgb& radiance) {
    return glm::dot(glm::abs(radiance), Rgb(1.0F / 3));
}

bool needs_parts(const PassLayout& layout) {
    return std::any_of(layout.places().begin(), layout.places().end(), [](const PassLayout::Place& place) {
        const Pass kind = place.pass.kind;
        return kind == Pass::light_group || kind == Pass::denoising_albedo ||
               std::any_of(kKindPasses.begin(), kKindPasses.end(), [&](const auto& own) { return own.first == kind; });
    });
}

/// Light that the picture's passes keep apart.
LightParts parts_of(const Picture& picture) {
    LightParts parts;
    if (!needs_parts(picture.layout)) {
        return parts;
    }
    const std::span<const std::uint32_t> groups = picture.scene->light_groups();
    parts.count = LightParts::of_group(groups.empty() ? 0 : groups.back()) + 1;
    parts.lobe_stride = picture.lighting.lobe_stride;
    for (const MaterialLobes& material : picture.lighting.materials) {
        for (std::size_t lobe = 0; lobe < parts.lobe_stride; ++lobe) {
            const bool glossy = lobe < material.lobes().size() && is_glossy(material.lobes()[lobe].shape);
            parts.of_lobe.push_back(glossy ? LightKind::glossy : LightKind::diffuse);
        }
    }
    return parts;
}

/// The places of parts that are passes.
std::vector<PartPlace> part_places(const Picture& picture) {
    std::vector<PartPlace> places;
    for (const auto& [pass, kind] : kKindPasses) {
        if (const PassLayout::Place* place = picture.layout.find(pass)) {
            places.push_back({place->first, LightParts::of_kind(kind)});
        }
    }
    if (const PassLayout::Place* place = picture.layout.find(Pass::denoising_albedo)) {
        for (const LightKind kind : {LightKind::emission, LightKind::environment}) {
            places.push_back({place->first, LightParts::of_kind(kind)});
        }
    }
    for (const PassLayout::Place& place : picture.layout.places()) {
        const std::size_t part = LightParts::of_group(place.pass.number);
        if (place.pass.kind == Pass::light_group && part < picture.parts.count) {
            places.push_back({place.first, part});
        }
    }
    return places;
}

bool takes_differences(const Material& material) {
    return material.shader != nullptr && material.shader->program.takes_differences();
}

/// step: of the neighbours, in pixels.
NeighbourRays beside(const Ray& ray, const Ray& right, const Ray& below, double step) {
    const auto way = [](const Ray& own) { return glm::normalize(Vec3d(own.direction)); };
    const auto mean = [&](const auto& value) {
        return (glm::distance(value(right), value(ray)) + glm::distance(value(below), value(ray))) / (2 * step);
    };
    return {right, below, mean([](const Ray& own) { return Vec3d(own.origin); }), mean(way)};
}

}  // namespace

Vec3d PixelSums::variance() const {
    const double count = rays;
    const Vec3d mean = radiance / count;
    // The variance of a coordinate over its unit interval is 1/12. Few rays are nearly always on a plane.
    const double share = rays < kLeastForPlane ? 0.0 : 12.0;
    const Vec3d linear = share * (along_x * along_x + along_y * along_y) / (count * count);
    return glm::max(squares / count - mean * mean - linear, Vec3d(0));
}

void PixelSums::add(const Rgb& ray_radiance, const Rgb& too_much, const Rgb& ray_noise, const glm::dvec2& from_center,
                    float ray_opacity, bool is_early) {
    const Vec3d whole = glm::clamp(Vec3d(ray_radiance), -kBrightestRay, kBrightestRay);
    const Vec3d shown = glm::clamp(Vec3d(ray_radiance - too_much), -kBrightestRay, kBrightestRay);
    opacity += double{ray_opacity};
    radiance += shown;
    early += is_early ? shown : Vec3d(0);
    const Vec3d shadow_noise = glm::min(Vec3d(ray_noise), kBrightestRay * kBrightestRay);
    squares += whole * whole - shadow_noise;
    noise += shadow_noise;
    along_x += from_center.x * shown;
    along_y += from_center.y * shown;
}

Picture::Picture(const CompiledScene& s, const Camera& c, int w, int h, const RenderSettings& r,
                 std::vector<glm::dvec2> points, std::uint32_t preview_points, const Stopped& stopped)
    : scene(&s),
      camera(c.moved(-s.origin())),
      settings(r),
      layout(r.passes),
      width(w),
      height(h),
      window(c.window(w, h)),
      pixel_points(std::move(points)),
      previews(preview_points),
      filter_places(pixel_points.size()),
      takes_differences(std::any_of(s.materials().begin(), s.materials().end(), shlight::takes_differences)),
      lighting(s, lobes_of_materials(s.materials(), r.order, r.tolerance, stopped), r.order, r.tolerance) {
    std::transform(pixel_points.begin(), pixel_points.end(), filter_places.begin(), [&](const glm::dvec2& point) {
        return glm::dvec2(r.filter.place(point.x), r.filter.place(point.y));
    });
    parts = parts_of(*this);
    const bool narrows = std::ranges::any_of(lighting.materials, [&](const MaterialLobes& material) {
        return has_narrower(material.lobes(), filtered_width());
    });
    if (settings.max_bounces > 0 && narrows) {
        filtered.emplace(s, lobes_of_materials(s.materials(), r.order, r.tolerance, stopped, filtered_width()), r.order,
                         r.tolerance);
    }
}

std::size_t Picture::stored_parts() const {
    const bool has_groups = std::ranges::any_of(
        layout.places(), [](const PassLayout::Place& place) { return place.pass.kind == Pass::light_group; });
    return has_groups ? 1 + parts.count - kLightKinds : 1;
}

Ray Picture::ray(double column, double row, const std::optional<glm::dvec2>& lens) const {
    return camera.ray(window.left + column / width * (window.right - window.left),
                      window.top + row / height * (window.bottom - window.top), lens);
}

double Picture::pixel_width(double distance) const {
    const Ray one = ray(0.5 * width, 0.5 * height, {});
    const Ray other = ray(0.5 * width + 1, 0.5 * height, {});
    return glm::distance(Vec3d(one.origin) + distance * Vec3d(one.direction),
                         Vec3d(other.origin) + distance * Vec3d(other.direction));
}

void Picture::guide(const Pilot& pilot) {
    const auto least = kLeastHidden * static_cast<double>(pilot.hidden + pilot.seen);
    if (pilot.seen > 0 && static_cast<double>(pilot.hidden) >= least) {
        lighting.sky_guide = std::make_unique<SkyGuide>(
            *lighting.environment, scene->rays(), static_cast<std::uint32_t>(settings.transparent_bounces),
            Vec3d(ray(0.5 * width, 0.5 * height, {}).origin),
            [this](double distance) { return pixel_width(distance) * width / kGuideSteps; });
    }
}

PathSettings Picture::paths(const StoredLight* stored) const {
    return {static_cast<std::uint32_t>(settings.transparent_bounces),
            stored != nullptr ? static_cast<std::uint32_t>(settings.max_bounces) : 0,
            static_cast<std::uint32_t>(settings.glossy_bounces),
            static_cast<std::uint32_t>(settings.transmission_bounces),
            stored,
            true,
            settings.filter_glossy,
            filtered_width(),
            static_cast<float>(settings.clamp_indirect),
            settings.darken_doubled && !doubled.empty() ? &doubled : nullptr};
}

PixelBatch::PixelBatch(const Picture& picture, const PathSettings& paths)
    : picture_(&picture),
      surfaces_(*picture.scene, picture.lighting.materials, paths),
      surface_passes_(*picture.scene, picture.camera, picture.settings.passes, picture.layout),
      hits_(picture.lighting.lobe_stride, picture.parts),
      lighting_(picture.lighting, picture.scene->rays(),
                static_cast<std::uint32_t>(picture.settings.transparent_bounces), picture.parts),
      part_places_(part_places(picture)) {}

void PixelBatch::add(std::span<const Pixel> pixels, const SampleRange& samples, std::uint32_t second_half,
                     std::span<PixelSums> sums, std::span<double> pass_sums) {
    StageClock clock(report_);
    trace(pixels, samples, hits_, ray_light_);
    if (surface_passes_.any_mean()) {
        surface_passes_.add(surfaces_, rays_.size(), samples.count, pass_sums);
    }
    clock.end(RenderStage::camera_rays);
    lighting_.add(pixel_seeds_, penumbrae_, samples, hits_, report_);
    StageClock last(report_);
    add_up(pixels, samples, second_half, sums);
    if (!picture_->parts.empty()) {
        add_up_parts(pass_sums);
    }
    last.end(RenderStage::pixels);
}

void PixelBatch::write_middles(std::span<const Pixel> pixels, bool guides, std::span<float> values) {
    rays_.clear();
    neighbours_.clear();
    for (const Pixel& pixel : pixels) {
        add_ray({pixel.column + 0.5, pixel.row + 0.5}, {}, 0, 0, 1);
    }
    surfaces_.trace(rays_, neighbours_, 1, hits_, ray_light_);
    surface_passes_.write_middles(surfaces_, rays_.size(), values);
    if (guides) {
        surface_passes_.write_guides(surfaces_, rays_.size(), values);
    }
}

Pilot PixelBatch::pilot(std::span<const Pixel> pixels, std::uint32_t shadow_rays) {
    const SampleRange first = {0, 1, shadow_rays, 0};
    trace(pixels, first, hits_, ray_light_);
    lighting_.add(pixel_seeds_, penumbrae_, first, hits_, report_);
    Pilot pilot;
    for (const Rgb& radiance : hits_.radiance) {
        pilot.reflected += brightness(radiance);
    }
    const std::uint32_t environment = LightBits::bit(picture_->lighting.extended.size());
    for (const LightBits& visibility : hits_.visibility) {
        pilot.hidden += (visibility.hidden & ~visibility.seen & environment) != 0 ? 1 : 0;
        pilot.seen += (visibility.seen & environment) != 0 ? 1 : 0;
    }
    return pilot;
}

/// The pixel's point and this are one of four dimensions. A preview's is the one before the first, the sequence's last.
PixelBatch::LensPoint PixelBatch::lens_point(std::uint32_t sample, std::uint32_t pixel_seed) const {
    return picture_->camera.has_depth_of_field()
               ? LensPoint(sobol_beyond(sample - picture_->previews, hash(pixel_seed, kLensSeed)))
               : std::nullopt;
}

void PixelBatch::trace(std::span<const Pixel> pixels, const SampleRange& samples, Hits& hits,
                       std::vector<RayLight>& light) {
    rays_.clear();
    neighbours_.clear();
    seed_pixels(pixels);
    // The rays of a pixel share its area.
    const std::uint32_t before = samples.first - std::min(samples.first, picture_->previews);
    const double step = 1 / std::sqrt(before + samples.count);
    for (std::size_t p = 0; p < pixels.size(); ++p) {
        for (std::uint32_t i = samples.first; i < samples.first + samples.count; ++i) {
            const glm::dvec2 middle(pixels[p].column + 0.5, pixels[p].row + 0.5);
            add_ray(middle + picture_->filter_places[i], lens_point(i, pixel_seeds_[p]), i, pixel_seeds_[p], step);
        }
    }
    surfaces_.trace(rays_, neighbours_, samples.count, hits, light);
    report_.hits += surfaces_.hit_count();
    report_.mirror_count += surfaces_.mirror_count();
}

void PixelBatch::add_ray(const glm::dvec2& place, const LensPoint& lens, std::uint32_t sample, std::uint32_t seed,
                         double step) {
    const Ray ray = picture_->ray(place.x, place.y, lens);
    rays_.push_back({ray, sample, seed});
    if (picture_->takes_differences) {
        const Ray right = picture_->ray(place.x + step, place.y, lens);
        const Ray below = picture_->ray(place.x, place.y + step, lens);
        neighbours_.push_back(beside(ray, right.empty() ? ray : right, below.empty() ? ray : below, step));
    }
}

void PixelBatch::seed_pixels(std::span<const Pixel> pixels) {
    pixel_seeds_.clear();
    penumbrae_.clear();
    for (const Pixel& pixel : pixels) {
        const std::uint32_t place =
            hash(static_cast<std::uint32_t>(pixel.column), static_cast<std::uint32_t>(pixel.row));
        const std::uint32_t seed = picture_->settings.seed;
        pixel_seeds_.push_back(seed == 0 ? place : hash(place, seed));
        penumbrae_.push_back(pixel.penumbrae);
    }
}

/// Paths that few rays find, and that bring much, would be bright dots: until the pixel has more rays they count for no
/// more than the light around it.
void PixelBatch::add_up(std::span<const Pixel> pixels, const SampleRange& samples, std::uint32_t second_half,
                        std::span<PixelSums> sums) {
    const auto from_center = [&](std::uint32_t sample) { return picture_->pixel_points[sample] - 0.5; };
    std::size_t hit = 0;
    std::size_t ray = 0;
    for (std::size_t pixel = 0; pixel < hits_.pixel_count(); ++pixel) {
        const std::size_t end = hits_.pixel_begin[pixel + 1];
        for (std::uint32_t i = 0; i < samples.count; ++i, ++ray) {
            Rgb radiance = ray_light_[ray].radiance;
            Rgb noise(0);
            Rgb by_path = ray_light_[ray].drawn;
            Rgb cut(0);
            for (; hit < end && hits_.sample[hit] == rays_[ray].sample; ++hit) {
                const bool bounced = hits_.path[hit] != PathKind::direct;
                const auto [is_drawn, chance] = surfaces_.hit_paths()[hit];
                const float left = bounced ? surfaces_.settings().kept(hits_.radiance[hit] / chance) : 1.0F;
                const Rgb own = left * hits_.radiance[hit];
                radiance += own;
                cut += hits_.radiance[hit] - own;
                noise += left * left * hits_.noise[hit];
                by_path += is_drawn ? own : Rgb(0);
            }
            const float kept = std::min(pixels[pixel].most_by_path / std::max(brightness(by_path), 1e-30F), 1.0F);
            const Rgb excess = kept < 1 ? (1 - kept) * by_path : Rgb(0);
            if ((kept < 1 || cut != Rgb(0)) && !picture_->parts.empty()) {
                take_from_parts(pixel, excess + cut);
            }
            sums[pixel].add(radiance, excess, noise, from_center(rays_[ray].sample), ray_light_[ray].opacity,
                            rays_[ray].sample < second_half);
        }
        sums[pixel].rays += samples.count;
        sums[pixel].visibility |= hits_.visibility[pixel];
        sums[pixel].shared_noise += glm::min(Vec3d(hits_.shared_noise[pixel]), kBrightestRay * kBrightestRay);
    }
}

void PixelBatch::take_from_parts(std::size_t pixel, const Rgb& light) {
    const std::span<Rgb> parts = hits_.apart.of(pixel);
    const std::size_t first = LightParts::of_kind(LightKind::glossy);
    const std::size_t last = LightParts::of_kind(LightKind::transmission_indirect);
    for (const std::span<Rgb> some : {parts.subspan(first, last + 1 - first), parts.subspan(LightParts::of_group(0))}) {
        const Rgb sum = std::accumulate(some.begin(), some.end(), Rgb(0));
        complete(some, glm::max(sum - light, glm::min(sum, Rgb(0))), 0);
    }
}

void PixelBatch::add_up_parts(std::span<double> pass_sums) const {
    for (std::size_t pixel = 0; pixel < hits_.pixel_count(); ++pixel) {
        const std::span<const Rgb> own = hits_.apart.of(pixel);
        for (const auto& [first, part] : part_places_) {
            for (int channel = 0; channel < 3; ++channel) {
                pass_sums[pixel * picture_->layout.stride() + first + static_cast<std::size_t>(channel)] +=
                    double{own[part][channel]};
            }
        }
    }
}

}  // namespace shlight
