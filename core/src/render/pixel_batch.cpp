// SPDX-License-Identifier: MIT
#include "render/pixel_batch.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <utility>

#include "shlight/sampling.h"

namespace shlight {
namespace {

/// DirectLight values that are held at a time, as many as fit the cache, but those of some lights at least.
constexpr std::size_t kValues = std::size_t{1} << 21;
constexpr std::size_t kLeastLights = 8;
/// Camera rays of a batch: enough for long batches, few enough for the cache.
constexpr std::size_t kMostBatchSamples = 4096;
constexpr std::size_t kLeastSamples = 256;
/// Camera rays that tell a gradient from an edge.
constexpr std::uint32_t kLeastForPlane = 8;
/// Of what a camera ray adds to a pixel; squares of brighter ones would leave floats.
constexpr double kBrightestRay = 1e18;
/// Of what casts shadows.
constexpr std::uint32_t kLightSeed = 0;
constexpr std::uint32_t kEnvironmentSeed = 0xFFFFFFFFU;
constexpr std::uint32_t kDeltaSeed = 0xFFFFFFFEU;
constexpr std::uint32_t kFarLightSeed = 0xFFFFFFFDU;
/// Of points of the aperture.
constexpr std::uint32_t kLensSeed = 0xFFFFFFFCU;

/// Times stages that follow each other.
class StageClock {
  public:
    explicit StageClock(RenderReport& report) : report_(&report), since_(std::chrono::steady_clock::now()) {}

    /// What passed since the stage before was this one.
    void end(RenderStage stage) {
        const auto now = std::chrono::steady_clock::now();
        report_->stage_seconds[static_cast<std::size_t>(stage)] += std::chrono::duration<double>(now - since_).count();
        since_ = now;
    }

  private:
    RenderReport* report_;
    std::chrono::steady_clock::time_point since_;
};

/// The kind of each pass that is one.
constexpr std::array<std::pair<Pass, LightKind>, kLightKinds> kKindPasses = {
    std::pair(Pass::diffuse_direct, LightKind::diffuse), std::pair(Pass::glossy_direct, LightKind::glossy),
    std::pair(Pass::emission, LightKind::emission), std::pair(Pass::environment, LightKind::environment)};

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
    parts.lobe_stride = picture.lobe_stride;
    for (const MaterialLobes& material : picture.materials) {
        for (std::size_t lobe = 0; lobe < picture.lobe_stride; ++lobe) {
            const bool glossy = lobe < material.lobes().size() && is_glossy(material.lobes()[lobe].shape);
            parts.of_lobe.push_back(glossy ? LightKind::glossy : LightKind::diffuse);
        }
    }
    return parts;
}

/// Where the parts that are passes go.
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

}  // namespace

Vec3d PixelSums::variance() const {
    const double count = rays;
    const Vec3d mean = radiance / count;
    // The variance of a coordinate over its unit interval is 1/12. Few rays are nearly always on a plane.
    const double share = rays < kLeastForPlane ? 0.0 : 12.0;
    const Vec3d linear = share * (along_x * along_x + along_y * along_y) / (count * count);
    return glm::max(squares / count - mean * mean - linear, Vec3d(0));
}

Vec3d PixelSums::shadow_variance() const {
    // n camera rays with m shadow rays each are n·m rays spread evenly over the light, whose error falls as
    // (n m)^-3/4: the noise of one camera ray, of a mean of m, is the m-th part of a shadow ray's variance. What rays
    // have in common is as wrong in their mean.
    return shadow_rays > 0 ? noise / (rays * std::sqrt(shadow_rays)) + shared_noise / std::sqrt(1.0 * rays) : Vec3d(0);
}

void PixelSums::add(const Rgb& ray_radiance, const Rgb& ray_noise, const glm::dvec2& from_center, float ray_opacity) {
    const Vec3d shown = glm::clamp(Vec3d(ray_radiance), -kBrightestRay, kBrightestRay);
    opacity += double{ray_opacity};
    radiance += shown;
    const Vec3d shadow_noise = glm::min(Vec3d(ray_noise), kBrightestRay * kBrightestRay);
    squares += shown * shown - shadow_noise;
    noise += shadow_noise;
    along_x += from_center.x * shown;
    along_y += from_center.y * shown;
}

Picture::Picture(const CompiledScene& s, const Camera& c, int w, int h, const RenderSettings& r,
                 std::vector<glm::dvec2> points, std::uint32_t preview_points, const Stopped& stopped)
    : scene(&s),
      camera(&c),
      settings(r),
      layout(r.passes),
      width(w),
      height(h),
      window(c.window(w, h)),
      pixel_points(std::move(points)),
      previews(preview_points),
      filter_places(pixel_points.size()),
      lights(s.lights().first(s.extended_light_count())),
      extended(pointers_to(lights)),
      deltas(pointers_to(s.lights().subspan(s.extended_light_count()))) {
    std::transform(pixel_points.begin(), pixel_points.end(), filter_places.begin(), [&](const glm::dvec2& point) {
        return glm::dvec2(r.filter.place(point.x), r.filter.place(point.y));
    });
    for (const Material& material : s.materials()) {
        end_if(stopped);
        materials.emplace_back(material.shader == nullptr ? material.bsdf.lobes() : lobes_of(*material.shader), r.order,
                               r.tolerance);
        takes_differences =
            takes_differences || (material.shader != nullptr && material.shader->program.takes_differences());
        lobe_stride = std::max(lobe_stride, materials.back().lobes().size());
    }
    parts = parts_of(*this);
    end_if(stopped);
    far = FarLights(s.lights(), materials, r.order);
    if (!s.environment().is_black()) {
        environment.emplace(s.environment(), materials, lobe_stride, r.order, r.tolerance);
    }
}

std::uint32_t Picture::batch_samples() const {
    const std::size_t values = std::max<std::size_t>(lights.size() * lobe_stride, 1);
    return static_cast<std::uint32_t>(std::clamp(kValues / values, kLeastSamples, kMostBatchSamples));
}

PixelBatch::PixelBatch(const Picture& picture)
    : picture_(&picture),
      surfaces_(*picture.scene, picture.materials, static_cast<std::uint32_t>(picture.settings.transparent_bounces)),
      surface_passes_(*picture.scene, *picture.camera, picture.settings.passes, picture.layout),
      hits_(picture.lobe_stride, picture.parts),
      far_light_sum_(picture.far, picture.materials, picture.settings.tolerance),
      tracer_(picture.scene->rays(), static_cast<std::uint32_t>(picture.settings.transparent_bounces)),
      shadowed_far_lights_(tracer_, picture.materials, picture.scene->lights()),
      shadowed_deltas_(tracer_, picture.materials, picture.lobe_stride),
      unshadowed_(picture.lobe_stride),
      shadowed_(tracer_, picture.materials, picture.lobe_stride, picture.parts),
      shadowed_environment_(tracer_, picture.scene->environment(), picture.materials),
      part_places_(part_places(picture)) {}

void PixelBatch::add(std::span<const Pixel> pixels, const SampleRange& samples, std::span<PixelSums> sums,
                     std::span<double> pass_sums) {
    StageClock clock(report_);
    trace_camera_rays(pixels, samples);
    if (surface_passes_.any_mean()) {
        surface_passes_.add(surfaces_, rays_.size(), samples.count, pass_sums);
    }
    clock.end(RenderStage::camera_rays);
    add_reflected(pixels, samples);
    StageClock last(report_);
    add_up(samples, sums);
    if (!picture_->parts.empty()) {
        add_up_parts(pass_sums);
    }
    last.end(RenderStage::pixels);
}

void PixelBatch::write_middles(std::span<const Pixel> pixels, std::span<float> values) {
    rays_.clear();
    neighbours_.clear();
    for (const Pixel& pixel : pixels) {
        add_ray({pixel.column + 0.5, pixel.row + 0.5}, {}, 0, 1);
    }
    surfaces_.trace(rays_, neighbours_, 1, hits_, ray_light_);
    surface_passes_.write_middles(surfaces_, rays_.size(), values);
}

double PixelBatch::reflected(std::span<const Pixel> pixels, std::uint32_t shadow_rays) {
    const SampleRange first = {0, 1, shadow_rays, 0};
    trace_camera_rays(pixels, first);
    add_reflected(pixels, first);
    double sum = 0;
    for (const Rgb& radiance : hits_.radiance) {
        sum += glm::dot(glm::abs(radiance), Rgb(1.0F / 3));
    }
    return sum;
}

void PixelBatch::add_reflected(std::span<const Pixel> pixels, const SampleRange& samples) {
    StageClock clock(report_);
    points_.assign(hits_, picture_->materials, picture_->lights, picture_->deltas, picture_->settings.tolerance);
    clock.end(RenderStage::views);
    sort_lights();
    add_deltas(pixels, samples);
    add_lights(pixels, samples);
    add_far_lights(pixels, samples);
    if (picture_->environment) {
        add_environment(pixels, samples);
    }
}

RenderReport PixelBatch::report() const {
    RenderReport report = report_;
    report.shadow_rays = shadowed_far_lights_.rays_traced() + shadowed_deltas_.rays_traced() + shadowed_.rays_traced() +
                         shadowed_environment_.rays_traced();
    return report;
}

Ray PixelBatch::camera_ray(double column, double row, const LensPoint& lens) const {
    const Window& window = picture_->window;
    return picture_->camera->ray(window.left + column / picture_->width * (window.right - window.left),
                                 window.top + row / picture_->height * (window.bottom - window.top), lens);
}

/// The pixel's point and this are one of four dimensions. A preview's is the one before the first, the sequence's last.
PixelBatch::LensPoint PixelBatch::lens_point(std::uint32_t sample, std::uint32_t pixel_seed) const {
    return picture_->camera->has_depth_of_field() ? LensPoint(sobol_beyond(sample - picture_->previews, pixel_seed))
                                                  : std::nullopt;
}

void PixelBatch::trace_camera_rays(std::span<const Pixel> pixels, const SampleRange& samples) {
    rays_.clear();
    neighbours_.clear();
    seed_pixels(pixels, kLensSeed);
    // The rays of a pixel share its area.
    const std::uint32_t before = samples.first - std::min(samples.first, picture_->previews);
    const double step = 1 / std::sqrt(before + samples.count);
    for (std::size_t p = 0; p < pixels.size(); ++p) {
        for (std::uint32_t i = samples.first; i < samples.first + samples.count; ++i) {
            const glm::dvec2 middle(pixels[p].column + 0.5, pixels[p].row + 0.5);
            add_ray(middle + picture_->filter_places[i], lens_point(i, pixel_seeds_[p]), i, step);
        }
    }
    surfaces_.trace(rays_, neighbours_, samples.count, hits_, ray_light_);
    report_.hits += hits_.size();
}

void PixelBatch::add_ray(const glm::dvec2& place, const LensPoint& lens, std::uint32_t sample, double step) {
    const Ray ray = camera_ray(place.x, place.y, lens);
    rays_.push_back({ray, sample});
    if (picture_->takes_differences) {
        const Ray right = camera_ray(place.x + step, place.y, lens);
        const Ray below = camera_ray(place.x, place.y + step, lens);
        neighbours_.push_back({right.empty() ? ray : right, below.empty() ? ray : below});
    }
}

void PixelBatch::sort_lights() {
    StageClock clock(report_);
    far_light_sum_.choose(points_);
    lights_.clear();
    delta_list_.clear();
    deltas_.reset();
    if (!far_light_sum_.empty()) {
        const std::span<const Light> all = picture_->scene->lights();
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (!far_light_sum_.holds(i)) {
                (i < picture_->lights.size() ? lights_ : delta_list_).push_back(&all[i]);
            }
        }
        deltas_.emplace(delta_list_);
    }
    brightness_.assign(hits_.pixel_count(), 0.0F);
    for (std::size_t pixel = 0; pixel < hits_.pixel_count() && !far_light_sum_.empty(); ++pixel) {
        brightness_[pixel] = far_light_sum_.brightness(pixel);
    }
    clock.end(RenderStage::light);
}

void PixelBatch::add_deltas(std::span<const Pixel> pixels, const SampleRange& samples) {
    StageClock clock(report_);
    const DeltaLights& deltas = deltas_ ? *deltas_ : picture_->deltas;
    if (deltas.padded_size() > 0) {
        seed_pixels(pixels, hash(kDeltaSeed, samples.first));
        shadowed_deltas_.add(deltas, points_, samples.shadow_rays > 0, pixel_seeds_, hits_, brightness_, report_);
    }
    clock.end(RenderStage::shadows);
}

void PixelBatch::add_lights(std::span<const Pixel> pixels, const SampleRange& samples) {
    const std::span<const Light* const> lights(far_light_sum_.empty() ? picture_->extended : lights_);
    if (lights.empty() && far_light_sum_.empty()) {
        return;
    }
    StageClock clock(report_);
    shadowed_.start(points_, brightness_);
    const std::size_t values = std::max<std::size_t>(points_.size() * picture_->lobe_stride, 1);
    const std::size_t most = std::max(kValues / values, kLeastLights);
    for (std::size_t first = 0; first < lights.size(); first += most) {
        const auto block = lights.subspan(first, std::min(most, lights.size() - first));
        unshadowed_.compute(points_, picture_->materials, block, picture_->light_error, report_);
        clock.end(RenderStage::light);
        seed_pixels(pixels, kLightSeed);
        shadowed_.add(block, unshadowed_, static_cast<std::uint32_t>(first), samples, pixel_seeds_, hits_);
        clock.end(RenderStage::shadows);
    }
}

void PixelBatch::add_far_lights(std::span<const Pixel> pixels, const SampleRange& samples) {
    if (far_light_sum_.empty()) {
        return;
    }
    StageClock clock(report_);
    seed_pixels(pixels, hash(kFarLightSeed, samples.first));
    shadowed_far_lights_.add(far_light_sum_, points_, samples, pixel_seeds_, shadowed_.brightness(), hits_);
    report_.summed_count += far_light_sum_.size() * hits_.size();
    clock.end(RenderStage::shadows);
}

void PixelBatch::add_environment(std::span<const Pixel> pixels, const SampleRange& samples) {
    StageClock clock(report_);
    picture_->environment->shade(points_, environment_, report_);
    clock.end(RenderStage::light);
    seed_pixels(pixels, kEnvironmentSeed);
    shadowed_environment_.add(*picture_->environment, picture_->scene->environment_group(), samples, environment_,
                              points_.size(), points_.of_hit, pixel_seeds_, hits_);
    clock.end(RenderStage::shadows);
}

void PixelBatch::seed_pixels(std::span<const Pixel> pixels, std::uint32_t light) {
    pixel_seeds_.clear();
    for (const Pixel& pixel : pixels) {
        const std::uint32_t seed =
            hash(static_cast<std::uint32_t>(pixel.column), static_cast<std::uint32_t>(pixel.row));
        pixel_seeds_.push_back(hash(seed, light));
    }
}

void PixelBatch::add_up(const SampleRange& samples, std::span<PixelSums> sums) const {
    const auto from_center = [&](std::uint32_t sample) { return picture_->pixel_points[sample] - 0.5; };
    std::size_t hit = 0;
    std::size_t ray = 0;
    for (std::size_t pixel = 0; pixel < hits_.pixel_count(); ++pixel) {
        const std::size_t end = hits_.pixel_begin[pixel + 1];
        for (std::uint32_t i = 0; i < samples.count; ++i, ++ray) {
            Rgb radiance = ray_light_[ray].radiance;
            Rgb noise(0);
            for (; hit < end && hits_.sample[hit] == rays_[ray].sample; ++hit) {
                radiance += hits_.radiance[hit];
                noise += hits_.noise[hit];
            }
            sums[pixel].add(radiance, noise, from_center(rays_[ray].sample), ray_light_[ray].opacity);
        }
        sums[pixel].rays += samples.count;
        sums[pixel].obstructed = sums[pixel].obstructed || hits_.obstructed[pixel] != 0;
        sums[pixel].shared_noise += glm::min(Vec3d(hits_.shared_noise[pixel]), kBrightestRay * kBrightestRay);
        sums[pixel].shadow_rays = samples.shadow_rays;
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
