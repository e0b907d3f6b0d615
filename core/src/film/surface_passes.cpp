// SPDX-License-Identifier: MIT
#include "film/surface_passes.h"

#include <algorithm>
#include <cmath>

#include "film/pass_image.h"

namespace shlight {
namespace {

/// Lobes narrower than kMirrorLike [rad] are mirrors for Cycles' denoiser. A surface from which such lobes reflect more
/// than the share kMostMirrorLike contributes the features of what it reflects.
constexpr double kMirrorLike = 0.075;
constexpr double kMostMirrorLike = 0.75;

double mean(const Rgb& color) {
    return (double{color.x} + double{color.y} + double{color.z}) / 3;
}

void add(const Vec3d& value, double* channels) {
    for (int i = 0; i < 3; ++i) {
        channels[i] += value[i];
    }
}

}  // namespace

SurfacePasses::SurfacePasses(const CompiledScene& scene, const Camera& camera, const PassSettings& settings,
                             const PassLayout& layout)
    : scene_(&scene), camera_(&camera), settings_(&settings), layout_(&layout) {
    place_.fill(kAbsent);
    for (const PassLayout::Place& place : layout.places()) {
        const Pass kind = place.pass.kind;
        place_[static_cast<std::size_t>(kind)] = place.first;
        const bool is_aov = kind == Pass::aov_value || kind == Pass::aov_color;
        any_aov_ = any_aov_ || is_aov;
        any_mean_ = any_mean_ || is_aov || kind == Pass::normal || kind == Pass::uv || kind == Pass::mist ||
                    kind == Pass::diffuse_color || kind == Pass::glossy_color || kind == Pass::transmission_color ||
                    kind == Pass::denoising_normal || kind == Pass::denoising_albedo || kind == Pass::denoising_depth ||
                    is_matte(kind);
        matte_size_ = is_matte(kind) ? place.size : matte_size_;
    }
}

bool SurfacePasses::is_opaque_enough(const Rgb& transparency) const {
    return transparency == Rgb(0) || 1 - mean(glm::min(transparency, Rgb(1))) >= settings_->alpha_threshold;
}

void SurfacePasses::add(const CameraSurfaces& surfaces, std::size_t rays, std::size_t rays_per_pixel,
                        std::span<double> sums) {
    rays_.assign(rays, {});
    for (const Surface& surface : surfaces.surfaces()) {
        if (surface.source != RaySource::camera) {
            continue;
        }
        double* pixel = sums.data() + surface.ray / rays_per_pixel * layout_->stride();
        RayState& ray = rays_[surface.ray];
        const Rgb transparency = surfaces.transparency(surface);
        const double share = mean(surface.throughput);
        surfaces.find_lobes(surface, lobes_);
        if (!ray.found) {
            add_aovs(surfaces, surface, share, pixel);
            ray.found = is_opaque_enough(transparency);
            if (ray.found) {
                add_first(surface, share, pixel);
            }
        }
        add_mattes(surface, share * (1 - mean(transparency)), pixel);
        add_colors(surface, pixel);
        if (has(Pass::transmission_color)) {
            shlight::add(Vec3d(surface.throughput * surfaces.refracted(surface)), at(Pass::transmission_color, pixel));
        }
        if (!ray.featured) {
            add_denoising(surface, share, transparency, ray, pixel);
        }
        if (has(Pass::mist)) {
            const Rgb alpha = glm::clamp(Rgb(1) - transparency, Rgb(0), Rgb(1));
            *at(Pass::mist, pixel) += clearness(surface.point.position) * mean(surface.throughput * alpha);
        }
    }
}

void SurfacePasses::add_first(const Surface& surface, double share, double* pixel) const {
    if (has(Pass::normal)) {
        Vec3d sum(0);
        for (const SurfaceLobe& lobe : lobes_) {
            sum += std::abs(mean(lobe.weight)) * lobe.viewers_normal();
        }
        const double length = glm::length(sum);
        shlight::add(share * (length > 0 ? sum / length : surface.point.shading_normal), at(Pass::normal, pixel));
    }
    if (has(Pass::uv)) {
        shlight::add(share * scene_->placed().uv(surface.hit), at(Pass::uv, pixel));
    }
}

void SurfacePasses::add_aovs(const CameraSurfaces& surfaces, const Surface& surface, double share,
                             double* pixel) const {
    const Material& material = scene_->materials()[surface.point.material];
    for (std::size_t i = 0; any_aov_ && i < material.aovs.size(); ++i) {
        const ShadedAov& aov = material.shader->aovs[i];
        const PassLayout::Place* place =
            layout_->find({aov.is_color ? Pass::aov_color : Pass::aov_value, material.aovs[i]});
        if (place == nullptr) {
            continue;
        }
        const std::uint32_t count = aov.is_color ? 3 : 1;
        for (std::uint32_t k = 0; k < count; ++k) {
            const float value = surfaces.result(surface, aov.value + k);
            pixel[place->first + k] += std::isfinite(value) ? share * double{value} : 0.0;
        }
        if (aov.is_color) {
            pixel[place->first + 3] += share;
        }
    }
}

void SurfacePasses::add_mattes(const Surface& surface, double share, double* pixel) const {
    const auto add_to = [&](Pass kind, float identity) {
        if (has(kind)) {
            add_to_matte({at(kind, pixel), matte_size_}, identity, share);
        }
    };
    const Label& object = scene_->placed().label(surface.hit);
    add_to(Pass::cryptomatte_object, object.name);
    add_to(Pass::cryptomatte_material, scene_->materials()[surface.point.material].label.name);
    add_to(Pass::cryptomatte_asset, object.asset);
}

Rgb SurfacePasses::color(const SurfaceLobe& lobe, const Surface& surface) {
    const double cosine = std::clamp(glm::dot(lobe.normal, surface.towards_viewer), 0.0, 1.0);
    const auto albedo_of = [&](const LobeShape& shape) {
        return has_two_widths(shape) ? lobe_albedo(shape, cosine) : table(shape).albedo(lobe_width(shape), cosine);
    };
    if (std::holds_alternative<TableShape>(lobe.shape)) {
        return lobe.weight * static_cast<float>(lobe_albedo(lobe.shape, cosine));
    }
    double albedo = albedo_of(lobe.shape);
    if (!lobe.several_bounces) {
        albedo /= albedo_of(sampled_shape(lobe.shape));
    }
    return lobe.weight * static_cast<float>(albedo);
}

const AlbedoTable& SurfacePasses::table(const LobeShape& shape) {
    const LobeShape of_any_width = with_width(shape, 0);
    std::shared_ptr<const AlbedoTable>& known = tables_[of_any_width];
    if (known == nullptr) {
        known = albedo_table(of_any_width);
    }
    return *known;
}

void SurfacePasses::add_colors(const Surface& surface, double* pixel) {
    if (!has(Pass::diffuse_color) && !has(Pass::glossy_color)) {
        return;
    }
    for (const SurfaceLobe& lobe : lobes_) {
        const Pass kind = is_glossy(lobe.shape) ? Pass::glossy_color : Pass::diffuse_color;
        if (has(kind)) {
            shlight::add(Vec3d(surface.throughput * color(lobe, surface)), at(kind, pixel));
        }
    }
}

/// Denoising features as in Cycles, for which rays continue through mirror-like and transparent surfaces.
void SurfacePasses::add_denoising(const Surface& surface, double share, const Rgb& transparency, RayState& ray,
                                  double* pixel) {
    if (has(Pass::denoising_depth)) {
        *at(Pass::denoising_depth, pixel) += share * (surface.ray_length() - ray.reached);
        ray.reached = surface.ray_length();
    }
    if (!has(Pass::denoising_normal) && !has(Pass::denoising_albedo)) {
        return;
    }
    double mirrored = mean(transparency);
    double all = mirrored;
    Vec3d normal = mirrored * surface.point.shading_normal;
    Rgb albedo(0);
    for (const SurfaceLobe& lobe : lobes_) {
        const Rgb reflected = color(lobe, surface);
        const double weight = std::abs(mean(reflected));
        const bool is_rough = !is_glossy(lobe.shape) || lobe_width(lobe.shape) > kMirrorLike;
        normal += weight * lobe.viewers_normal();
        all += weight;
        mirrored += is_rough ? 0.0 : weight;
        albedo += is_rough ? reflected : Rgb(0);
    }
    ray.featured = all == 0 || mirrored < kMostMirrorLike * all;
    if (!ray.featured) {
        return;
    }
    if (has(Pass::denoising_normal)) {
        const Vec3d turned = camera_->turned_to_frame(all > 0 ? normal / all : Vec3d(0));
        shlight::add(share * Vec3d(turned.x, turned.y, -turned.z), at(Pass::denoising_normal, pixel));
    }
    if (has(Pass::denoising_albedo)) {
        shlight::add(Vec3d(surface.throughput * albedo), at(Pass::denoising_albedo, pixel));
    }
}

double SurfacePasses::clearness(const Vec3d& position) const {
    const MistRange& mist = settings_->mist;
    const double into = camera_->distance(position) - mist.start;
    const double share = mist.depth > 0 ? std::clamp(into / mist.depth, 0.0, 1.0) : 0.0;
    return 1 - std::pow(share, mist.falloff);
}

void SurfacePasses::write_middles(const CameraSurfaces& surfaces, std::size_t rays, std::span<float> values) {
    rays_.assign(rays, {});
    for (const Surface& surface : surfaces.surfaces()) {
        if (surface.source != RaySource::camera) {
            continue;
        }
        RayState& ray = rays_[surface.ray];
        if (ray.found || !is_opaque_enough(surfaces.transparency(surface))) {
            continue;
        }
        ray.found = true;
        float* pixel = values.data() + surface.ray * layout_->stride();
        const auto write = [&](Pass kind, double value) {
            if (has(kind)) {
                *at(kind, pixel) = static_cast<float>(value);
            }
        };
        write(Pass::depth, camera_->depth(surface.point.position));
        write(Pass::object_index, double{scene_->placed().label(surface.hit).index});
        write(Pass::material_index, double{scene_->materials()[surface.point.material].label.index});
        for (int i = 0; i < 3 && has(Pass::position); ++i) {
            at(Pass::position, pixel)[i] = static_cast<float>(surface.point.position[i] + scene_->origin()[i]);
        }
    }
}

void SurfacePasses::write_guides(const CameraSurfaces& surfaces, std::size_t rays, std::span<float> values) {
    of_middles_.assign(rays * layout_->stride(), 0);
    add(surfaces, rays, 1, of_middles_);
    for (const PassLayout::Place& place : layout_->places()) {
        for (std::size_t ray = 0; ray < rays && is_guide(place.pass.kind); ++ray) {
            const std::size_t first = ray * layout_->stride() + place.first;
            std::transform(of_middles_.begin() + static_cast<std::ptrdiff_t>(first),
                           of_middles_.begin() + static_cast<std::ptrdiff_t>(first + place.size),
                           values.begin() + static_cast<std::ptrdiff_t>(first),
                           [](double value) { return static_cast<float>(value); });
        }
    }
}

}  // namespace shlight
