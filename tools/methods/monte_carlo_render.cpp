// SPDX-License-Identifier: MIT
#include "monte_carlo_render.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "base/checks.h"
#include "delta_view.h"
#include "lights/cap_sampling.h"
#include "lights/local_light.h"
#include "lights/shadow_ray_spawner.h"
#include "random_directions.h"
#include "random_numbers.h"
#include "shlight/render.h"
#include "surface_reflection.h"
#include "surfaces/placed_meshes.h"
#include "surfaces/visible_lamps.h"
#include "tracing/hits.h"

namespace shlight::methods {
namespace {

constexpr int kMostSamples = 1 << 20;
/// Number of camera rays that are followed at a time.
constexpr std::size_t kBatch = 4096;

/// Samples the direction to a light from a hit.
class LightInView {
  public:
    /// Precondition: the light is seen, and has an extent.
    void reset(const Light& light, const ShadingFrame& frame) {
        if (const std::optional<CapView> cap = cap_view(light, frame)) {
            cone_.emplace(circle_of(*cap));
            cap_.emplace(*cap);
            return;
        }
        cone_.reset();
        ellipse_.reset();
        if (const auto* disk = std::get_if<DiskLight>(&light)) {
            ellipse_.emplace(Ellipse{frame.point_to_local(disk->center), frame.to_local(disk->half_axis_u),
                                     frame.to_local(disk->half_axis_v)});
            return;
        }
        const auto& polygon = std::get<PolygonLight>(light);
        normal_ = frame.to_local(polygon.normal);
        height_ = glm::dot(polygon.normal, polygon.vertices[0] - frame.origin);
        triangles_.clear();
        for (const Triangle& t : polygon.triangles) {
            triangles_.add(frame.point_to_local(polygon.vertices[t.x]), frame.point_to_local(polygon.vertices[t.y]),
                           frame.point_to_local(polygon.vertices[t.z]));
        }
    }
    RandomDirection sample(const glm::dvec2& point) const {
        if (cone_) {
            return cone_->sample(point);
        }
        if (ellipse_) {
            return ellipse_->sample(point);
        }
        return triangles_.empty() ? RandomDirection{normal_, 0} : triangles_.sample(point);
    }
    double density(const Vec3d& direction) const {
        return cone_      ? cone_->density(direction)
               : ellipse_ ? ellipse_->density(direction)
                          : triangles_.density(direction);
    }
    /// Distance to the light's surface, in a direction of positive density.
    std::optional<double> distance(const Vec3d& direction) const {
        return cone_      ? cap_->meets(direction)
               : ellipse_ ? std::optional(ellipse_->distance(direction))
                          : std::optional(height_ / glm::dot(normal_, direction));
    }

  private:
    std::optional<ConeSampler> cone_;
    std::optional<CapSampler> cap_;
    std::optional<EllipseAreaSampler> ellipse_;
    TriangleSampler triangles_;
    Vec3d normal_{0};
    double height_ = 0;
};

struct Picture {
    const CompiledScene& scene;
    Camera camera;
    int width, height;
    MonteCarloSettings settings;
    Window window;

    std::size_t samples() const { return static_cast<std::size_t>(settings.samples); }
    std::size_t pixels() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
};

/// Renders pixels; one per thread.
class Worker {
  public:
    explicit Worker(const Picture& picture) : picture_(&picture) {}
    /// pixels: numbers of pixels in the image.
    void render(std::size_t first, std::size_t count, std::span<float> image);

  private:
    void trace_camera_rays(std::size_t first, std::size_t samples);
    void shade(std::size_t hit);
    void shade(const Light& light, std::size_t hit, const RandomDirection& reflected);
    void shade_by_delta(const Light& light, std::size_t hit);
    /// The light's radiance in this direction, times f·cos.
    Rgb reflected_radiance(const Light& light, const Vec3d& direction) const {
        const LightTraits& traits = traits_of(light);
        return strength_of(light) * reflection_.value(direction, traits.lights_diffuse, traits.lights_glossy);
    }
    void shade_environment(std::size_t hit, const RandomDirection& reflected);
    void push(const Light& light, std::size_t hit, const Vec3d& direction, double distance, const Rgb& radiance);
    void push(const Ray& ray, const Rgb& radiance, std::size_t hit);

    const Picture* picture_;
    std::vector<RandomNumbers> random_;  // one for each pixel
    std::vector<Vec3d> radiance_;        // sums, one for each pixel
    std::vector<std::size_t> covered_;   // likewise
    std::vector<Ray> rays_;
    std::vector<std::size_t> pixel_of_camera_ray_;
    std::vector<RayHit> ray_hits_;
    Hits hits_{0};  // weights are those of reflection_
    std::vector<std::size_t> pixel_of_hit_;
    std::vector<double> azimuth_of_hit_;
    SurfaceReflection reflection_;
    LightInView light_;
    std::vector<Ray> shadow_rays_;
    std::vector<Rgb> shadowed_;              // radiance that each ray adds if unblocked
    std::vector<std::size_t> pixel_of_ray_;  // pixel that the ray adds to
    std::vector<Rgb> visible_;
};

void Worker::render(std::size_t first, std::size_t count, std::span<float> image) {
    random_.clear();
    for (std::size_t pixel = first; pixel < first + count; ++pixel) {
        random_.emplace_back(hash(picture_->settings.seed, static_cast<std::uint32_t>(pixel)));
    }
    radiance_.assign(count, Vec3d(0));
    covered_.assign(count, 0);
    const std::size_t most = std::max<std::size_t>(1, kBatch / count);
    for (std::size_t done = 0; done < picture_->samples(); done += most) {
        trace_camera_rays(first, std::min(most, picture_->samples() - done));
        shadow_rays_.clear();
        shadowed_.clear();
        pixel_of_ray_.clear();
        for (std::size_t hit = 0; hit < hits_.size(); ++hit) {
            ++covered_[pixel_of_hit_[hit]];
            shade(hit);
        }
        visible_.resize(shadow_rays_.size());
        picture_->scene.rays().visibility(shadow_rays_, 0, visible_);
        for (std::size_t i = 0; i < visible_.size(); ++i) {
            if (visible_[i] != Rgb(0)) {
                radiance_[pixel_of_ray_[i]] += Vec3d(shadowed_[i]);
            }
        }
    }
    const auto samples = static_cast<double>(picture_->settings.samples);
    for (std::size_t i = 0; i < count; ++i) {
        float* rgba = &image[4 * (first + i)];
        for (int channel = 0; channel < 3; ++channel) {
            rgba[channel] = static_cast<float>(radiance_[i][channel] / samples);
        }
        rgba[3] = static_cast<float>(static_cast<double>(covered_[i]) / samples);
    }
}

void Worker::trace_camera_rays(std::size_t first, std::size_t samples) {
    const Picture& p = *picture_;
    const auto columns = static_cast<std::size_t>(p.width);
    rays_.clear();
    pixel_of_camera_ray_.clear();
    for (std::size_t pixel = 0; pixel < random_.size(); ++pixel) {
        const auto column = static_cast<double>((first + pixel) % columns);
        const std::size_t above = (first + pixel) / columns;
        for (std::size_t i = 0; i < samples; ++i) {
            const glm::dvec2 place = random_[pixel].point();
            const double x = (column + place.x) / p.width;
            const double y = (static_cast<double>(above) + place.y) / p.height;
            const glm::dvec2 lens = p.camera.has_depth_of_field() ? random_[pixel].point() : glm::dvec2(0.5);
            rays_.push_back(p.camera.ray(p.window.left + x * (p.window.right - p.window.left),
                                         p.window.top + y * (p.window.bottom - p.window.top), lens));
            pixel_of_camera_ray_.push_back(pixel);
        }
    }
    ray_hits_.resize(rays_.size());
    p.scene.rays().intersect(rays_, ray_hits_);
    hits_.clear();
    pixel_of_hit_.clear();
    azimuth_of_hit_.clear();
    for (std::size_t i = 0; i < rays_.size(); ++i) {
        const std::size_t pixel = pixel_of_camera_ray_[i];
        if (!ray_hits_[i].missed()) {
            const SurfacePoint surface = p.scene.placed().surface(ray_hits_[i], rays_[i].direction);
            const Vec3d direction = glm::normalize(Vec3d(rays_[i].direction));
            const double distance = glm::dot(surface.position - Vec3d(rays_[i].origin), direction);
            radiance_[pixel] +=
                Vec3d(p.scene.placed().emission(p.scene.materials()[surface.material], ray_hits_[i], -direction));
            radiance_[pixel] += Vec3d(p.scene.visible_lamps(LampViewer::camera).radiance(rays_[i], distance));
            const ShadingFrame frame = shading_frame(surface.position, surface.shading_normal, -direction);
            hits_.add(surface, {}, frame, view_cosine(frame.z, -direction), {}, {}, 0, PathKind::direct, 0);
            pixel_of_hit_.push_back(pixel);
            azimuth_of_hit_.push_back(p.scene.placed().azimuth(ray_hits_[i], frame));
            continue;
        }
        if (rays_[i].empty()) {
            ++covered_[pixel];
            continue;
        }
        radiance_[pixel] += Vec3d(p.scene.visible_lamps(LampViewer::camera).radiance(rays_[i], std::nullopt));
        if (p.scene.background_visible()) {
            radiance_[pixel] += Vec3d(p.scene.background().radiance(glm::normalize(Vec3d(rays_[i].direction))));
            ++covered_[pixel];
        }
    }
}

void Worker::shade(std::size_t hit) {
    reflection_.reset(picture_->scene.materials()[hits_.material[hit]].bsdf, hits_.cos_theta_o[hit],
                      azimuth_of_hit_[hit]);
    RandomNumbers& random = random_[pixel_of_hit_[hit]];
    const double choice = random.next();
    const RandomDirection reflected = reflection_.sample(choice, random.point());
    for (const Light& light : picture_->scene.lights()) {
        if (is_delta(light)) {
            shade_by_delta(light, hit);
        } else if (LocalLight().look(light, hits_.frame[hit], hits_.error[hit])) {
            shade(light, hit, reflected);
        }
    }
    if (!picture_->scene.environment().is_black()) {
        shade_environment(hit, reflected);
    }
}

/// Environment light, sampled by the material only, because light from everywhere has no better density.
void Worker::shade_environment(std::size_t hit, const RandomDirection& reflected) {
    const ShadingFrame& frame = hits_.frame[hit];
    const ShadowRaySpawner start(frame, hits_.shadow_origin[hit], Vec3d(0));
    const Environment& environment = picture_->scene.environment();
    if (reflected.density > 0) {
        push(start.along(reflected.direction),
             environment.radiance(frame.to_world(reflected.direction)) * reflection_.value(reflected.direction) *
                 static_cast<float>(1 / reflected.density),
             hit);
    }
    const Vec3d mirror(-reflection_.view().x, 0, reflection_.view().z);
    push(start.along(mirror), environment.radiance(frame.to_world(mirror)) * reflection_.mirrored(), hit);
}

void Worker::shade_by_delta(const Light& light, std::size_t hit) {
    if (const auto seen = delta_view(light, hits_.frame[hit], hits_.error[hit])) {
        push(light, hit, seen->direction, seen->distance,
             reflected_radiance(light, seen->direction) * static_cast<float>(seen->irradiance));
    }
}

void Worker::shade(const Light& light, std::size_t hit, const RandomDirection& reflected) {
    const ShadingFrame& frame = hits_.frame[hit];
    light_.reset(light, frame);
    const ProfileView profile(light, frame);
    const auto add = [&](const Vec3d& direction, const Rgb& radiance) {
        if (const std::optional<double> distance = light_.distance(direction)) {
            push(light, hit, direction, *distance, radiance * static_cast<float>(profile.factor(direction)));
        }
    };
    const RandomDirection to_light = light_.sample(random_[pixel_of_hit_[hit]].point());
    if (to_light.density > 0) {
        const double density = to_light.density + reflection_.density(to_light.direction);
        add(to_light.direction, reflected_radiance(light, to_light.direction) * static_cast<float>(1 / density));
    }
    if (const double other = reflected.density > 0 ? light_.density(reflected.direction) : 0; other > 0) {
        const double density = other + reflected.density;
        add(reflected.direction, reflected_radiance(light, reflected.direction) * static_cast<float>(1 / density));
    }
    const Vec3d mirror(-reflection_.view().x, 0, reflection_.view().z);
    if (traits_of(light).lights_glossy && reflection_.mirrored() != Rgb(0) && light_.density(mirror) > 0) {
        add(mirror, strength_of(light) * reflection_.mirrored());
    }
}

void Worker::push(const Light& light, std::size_t hit, const Vec3d& direction, double distance, const Rgb& radiance) {
    if (!traits_of(light).casts_shadows) {
        radiance_[pixel_of_hit_[hit]] += Vec3d(radiance);
        return;
    }
    const ShadingFrame& frame = hits_.frame[hit];
    const ShadowRaySpawner start(frame, hits_.shadow_origin[hit], target_offset(light, frame));
    push(start.towards(direction, distance), radiance, hit);
}

void Worker::push(const Ray& ray, const Rgb& radiance, std::size_t hit) {
    if (radiance != Rgb(0)) {
        shadow_rays_.push_back(ray);
        shadowed_.push_back(radiance);
        pixel_of_ray_.push_back(pixel_of_hit_[hit]);
    }
}

}  // namespace

void check_monte_carlo(const MonteCarloSettings& settings, int width, int height) {
    RenderSettings common;
    common.threads = settings.threads;
    check_render(common, width, height);
    if (settings.samples < 1 || settings.samples > kMostSamples) {
        reject("samples must be 1 … " + std::to_string(kMostSamples) + ", got " + std::to_string(settings.samples));
    }
}

void render_monte_carlo(const CompiledScene& scene, const Camera& camera, int width, int height,
                        const MonteCarloSettings& settings, std::span<float> image, const Progress& progress) {
    check_monte_carlo(settings, width, height);
    for (const Light& light : scene.lights()) {
        if (std::holds_alternative<MeshLight>(light)) {
            reject("scene: render_monte_carlo knows emissive meshes of a few faces only");
        }
    }
    const Picture picture = {scene,    camera.moved(-scene.origin()), width, height,
                             settings, camera.window(width, height)};
    check_size("image", image.size(), 4 * picture.pixels());
    tbb::enumerable_thread_specific<Worker> workers([&picture] { return Worker(picture); });
    const std::size_t each = std::max<std::size_t>(1, kBatch / picture.samples());
    const std::size_t count = (picture.pixels() + each - 1) / each;
    std::atomic<std::size_t> done = 0;
    const auto work = [&](const Watch& caller) {
        parallel_for(count, settings.threads, [&](std::size_t i) {
            end_if(caller.stopped);
            workers.local().render(i * each, std::min(each, picture.pixels() - i * each), image);
            ++done;
        });
    };
    const auto look = [&] { return progress(static_cast<double>(done) / static_cast<double>(count)); };
    run_watched(settings.threads, work, progress ? std::function<bool()>(look) : nullptr);
    if (progress && !progress(1)) {
        throw RenderCancelled();
    }
}

}  // namespace shlight::methods
