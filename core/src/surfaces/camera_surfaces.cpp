// SPDX-License-Identifier: MIT
#include "surfaces/camera_surfaces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace shlight {
namespace {

/// Normals that differ by less are those of floats and doubles of the same surface.
constexpr double kSameNormal = 1e-6;

bool is_bumped(const SurfaceLobe& lobe) {
    const auto* diffuse = std::get_if<DiffuseShape>(&lobe.shape);
    return diffuse != nullptr && diffuse->kind == Diffuse::bumped;
}

constexpr float kLeastWidth = kLeastRoughness * kLeastRoughness;

}  // namespace

void CameraSurfaces::trace(std::span<const CameraRay> rays, std::span<const NeighbourRays> neighbours,
                           std::size_t rays_per_pixel, Hits& hits, std::vector<RayLight>& light) {
    surfaces_.clear();
    results_.clear();
    hit_count_ = 0;
    mirror_count_ = 0;
    light.assign(rays.size(), {});
    hits.apart.reset(rays.size() / rays_per_pixel);
    const Sink sink = {light, hits.apart, rays_per_pixel};
    segments_.clear();
    parts_.clear();
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (rays[i].ray.empty()) {
            light[i].opacity = 1;  // outside a panorama's image, as Cycles has it
        } else {
            start({i, false, 0, Rgb(1), rays[i].ray}, rays[i].ray);
        }
    }
    while (!segments_.empty()) {
        const std::size_t first = surfaces_.size();
        meet(sink);
        run_programs(neighbours, first);
        pass_on(first, sink);
    }
    add_hits(rays, rays_per_pixel, hits);
}

void CameraSurfaces::start(const Segment& segment, const Ray& part) {
    segments_.push_back(segment);
    parts_.push_back(part);
}

/// The next surface of each path, or what lies behind all of them.
void CameraSurfaces::meet(const Sink& sink) {
    met_.resize(parts_.size());
    scene_->rays().intersect(parts_, met_);
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        const Segment& segment = segments_[i];
        const LampViewer viewer = segment.is_mirrored ? LampViewer::mirror : LampViewer::camera;
        if (met_[i].missed()) {
            add_lamps(viewer, segment, parts_[i], std::nullopt, sink);
            leave_scene(segment, sink);
            continue;
        }
        const SurfacePoint point = scene_->placed().surface(met_[i], segment.whole.direction);
        const Vec3d direction = glm::normalize(Vec3d(segment.whole.direction));
        const double distance = glm::dot(point.position - Vec3d(segment.whole.origin), direction);
        add_lamps(viewer, segment, parts_[i], distance, sink);
        surfaces_.push_back({segment, met_[i], point, -direction, distance, 0, 0});
    }
    segments_.clear();
    parts_.clear();
}

ShadedPlace CameraSurfaces::place_of(const Surface& surface, const NeighbourRays* neighbours) const {
    ShadedPlace place(surface.point, surface.hit, surface.towards_viewer, surface.ray_length(), surface.depth);
    if (neighbours != nullptr) {
        const Vec3d& normal = surface.point.geometric_normal;
        place.at[1] = scene_->placed().neighbour(place.at[0], normal, surface.distance, neighbours->right);
        place.at[2] = scene_->placed().neighbour(place.at[0], normal, surface.distance, neighbours->below);
    }
    return place;
}

void CameraSurfaces::leave_scene(const Segment& segment, const Sink& sink) {
    const Environment* background = segment.is_mirrored ? &scene_->environment() : scene_->background();
    const Rgb& left = segment.throughput;
    const Vec3d direction = glm::normalize(Vec3d(segment.whole.direction));
    if (background != nullptr) {
        add_light(segment, LightKind::environment, scene_->environment_group(), left * background->radiance(direction),
                  sink);
    } else if (!sink.apart.empty()) {
        sink.apart.of(segment.ray / sink.rays_per_pixel)[LightParts::of_kind(LightKind::environment)] +=
            left * scene_->environment().radiance(direction);
    }
    if (!segment.is_mirrored) {
        sink.light[segment.ray].opacity = background != nullptr ? 1.0F : 1.0F - (left.x + left.y + left.z) / 3;
    }
}

void CameraSurfaces::add_lamps(LampViewer viewer, const Segment& segment, const Ray& part,
                               const std::optional<double>& surface, const Sink& sink) {
    const VisibleLamps& lamps = scene_->visible_lamps(viewer);
    if (lamps.empty()) {
        return;
    }
    by_group_.assign(sink.apart.empty() ? 0 : sink.apart.parts().count - kLightKinds, Rgb(0));
    const Rgb radiance = lamps.radiance(part, surface, by_group_);
    sink.light[segment.ray].radiance += segment.throughput * radiance;
    for (std::size_t group = 0; group < by_group_.size(); ++group) {
        sink.apart.add(segment.ray / sink.rays_per_pixel, segment.is_mirrored ? LightKind::glossy : LightKind::emission,
                       static_cast<std::uint32_t>(group), segment.throughput * by_group_[group]);
    }
}

void CameraSurfaces::add_light(const Segment& segment, LightKind kind, std::uint32_t group, const Rgb& radiance,
                               const Sink& sink) {
    sink.light[segment.ray].radiance += radiance;
    if (!sink.apart.empty() && radiance != Rgb(0)) {  // groups without light have no part
        sink.apart.add(segment.ray / sink.rays_per_pixel, segment.is_mirrored ? LightKind::glossy : kind, group,
                       radiance);
    }
}

void CameraSurfaces::run_programs(std::span<const NeighbourRays> neighbours, std::size_t first) {
    order_.clear();
    material_of_.resize(surfaces_.size());
    for (std::size_t i = first; i < surfaces_.size(); ++i) {
        material_of_[i] = surfaces_[i].point.material;
        const SurfaceShader* shader = scene_->materials()[material_of_[i]].shader.get();
        if (shader != nullptr && (!surfaces_[i].is_mirrored || shader->transparency)) {
            order_.push_back(static_cast<std::uint32_t>(i));
        }
    }
    for_each_run(order_, material_of_, [&](auto surfaces) { run_program(neighbours, surfaces); });
}

void CameraSurfaces::run_program(std::span<const NeighbourRays> neighbours, std::span<const std::uint32_t> surfaces) {
    const Material& material = scene_->materials()[surfaces_[surfaces.front()].point.material];
    const ShaderProgram& program = material.shader->program;
    places_.clear();
    for (const std::uint32_t i : surfaces) {
        // Neighbours of mirrored rays are unknown.
        const bool differs = program.takes_differences() && !surfaces_[i].is_mirrored;
        places_.push_back(place_of(surfaces_[i], differs ? &neighbours[surfaces_[i].ray] : nullptr));
    }
    const std::size_t begin = results_.size();
    results_.resize(begin + program.result_count() * surfaces.size());
    scene_->placed().run(program, material, places_, program.takes_differences(), registers_,
                         std::span(results_).subspan(begin));
    for (std::size_t k = 0; k < surfaces.size(); ++k) {
        surfaces_[surfaces[k]].results = begin + k;
        surfaces_[surfaces[k]].stride = surfaces.size();
    }
}

Vec3d CameraSurfaces::vector(const Surface& surface, std::uint32_t result) const {
    const auto at = [&](std::uint32_t i) { return double{this->result(surface, result + i)}; };
    return {at(0), at(1), at(2)};
}

Rgb CameraSurfaces::color(const Surface& surface, std::uint32_t result) const {
    const Rgb color(vector(surface, result));
    return {std::isfinite(color.x) ? color.x : 0.0F, std::isfinite(color.y) ? color.y : 0.0F,
            std::isfinite(color.z) ? color.z : 0.0F};
}

float CameraSurfaces::width(const Surface& surface, std::uint32_t result) const {
    const float alpha = this->result(surface, result);
    // A NaN is the least too.
    return std::min(alpha > kLeastWidth ? alpha : kLeastWidth, 1.0F);
}

void CameraSurfaces::add_emission(const Surface& surface, const Sink& sink) {
    const Material& material = scene_->materials()[surface.point.material];
    const bool by_program = material.shader != nullptr && !surface.is_mirrored;
    if (by_program && !material.shader->emission) {
        return;
    }
    // The program's emission is what the camera sees; other surfaces are lit by the material's.
    const Rgb emission = by_program ? color(surface, *material.shader->emission)
                                    : scene_->placed().emission(material, surface.hit, surface.towards_viewer);
    add_light(surface, LightKind::emission, material.group, surface.throughput * emission, sink);
}

/// Emission of the surfaces met last, and the paths that go on from there.
void CameraSurfaces::pass_on(std::size_t first, const Sink& sink) {
    for (std::size_t i = first; i < surfaces_.size(); ++i) {
        const Surface& surface = surfaces_[i];
        if (!surface.is_mirrored) {
            hit_count_ += surface.depth == 0 ? 1 : 0;
            sink.light[surface.ray].opacity = 1;
        }
        add_emission(surface, sink);
        if (surface.depth > transparent_bounces_) {
            continue;
        }
        const Material& material = scene_->materials()[surface.point.material];
        if (material.shader != nullptr && material.shader->transparency) {
            const Rgb throughput = surface.throughput * transparency(surface);
            if (throughput != Rgb(0)) {
                start({surface.ray, surface.is_mirrored, surface.depth + 1, throughput, surface.whole},
                      behind(surface.whole, surface.hit));
            }
        }
        if (!surface.is_mirrored) {
            reflect(surface, sink);
        }
    }
}

void CameraSurfaces::reflect(const Surface& surface, const Sink& sink) {
    const auto lobes = materials_[surface.point.material].lobes();
    if (std::none_of(lobes.begin(), lobes.end(), [](const Lobe& lobe) { return is_mirror(lobe.shape); })) {
        return;
    }
    find_lobes(surface, lobes_);
    for (const SurfaceLobe& lobe : lobes_) {
        if (!is_mirror(lobe.shape) || lobe.weight == Rgb(0)) {
            continue;
        }
        const ShadingFrame frame = shading_frame(surface.point.position, lobe.normal, surface.towards_viewer);
        const double cosine = view_cosine(frame.z, surface.towards_viewer);
        const Vec3d direction = frame.to_world(mirrored({std::sqrt(1 - cosine * cosine), 0, cosine}));
        const Ray ray = {Vec3f(surface.point.off_surface()), 0, Vec3f(direction)};
        const double let_in = scene_->placed().terminator(surface.hit, surface.point).let_in(cosine);
        const auto albedo = static_cast<float>(let_in * lobe_albedo(lobe.shape, cosine));
        const Segment segment = {surface.ray, true, 0, surface.throughput * lobe.weight * albedo, ray};
        add_lamps(LampViewer::unblocked_mirror, segment, ray, std::nullopt, sink);
        start(segment, ray);
        ++mirror_count_;
    }
}

void CameraSurfaces::add_hits(std::span<const CameraRay> rays, std::size_t rays_per_pixel, Hits& hits) {
    hits.clear();
    order_.resize(surfaces_.size());
    std::iota(order_.begin(), order_.end(), 0U);
    std::erase_if(order_, [&](std::uint32_t i) { return surfaces_[i].is_mirrored; });
    if (!order_.empty() && surfaces_[order_.back()].depth > 0) {
        std::stable_sort(order_.begin(), order_.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return surfaces_[a].ray < surfaces_[b].ray; });
    }
    auto next = order_.begin();
    for (std::size_t end = rays_per_pixel; end <= rays.size(); end += rays_per_pixel) {
        for (; next != order_.end() && surfaces_[*next].ray < end; ++next) {
            add_hit(rays[surfaces_[*next].ray], surfaces_[*next], hits);
        }
        hits.end_pixel();
    }
}

Vec3d CameraSurfaces::normal(const Surface& surface, const ShadedLobe& lobe) const {
    const Vec3d& smooth = surface.point.shading_normal;
    if (!lobe.normal) {
        return smooth;
    }
    const Vec3d own = vector(surface, *lobe.normal);
    const double length = glm::length(own);
    const bool differs = length > 0 && std::isfinite(length) && glm::distance(own / length, smooth) > kSameNormal;
    return differs ? own / length : smooth;
}

Rgb CameraSurfaces::transparency(const Surface& surface) const {
    const SurfaceShader* shader = scene_->materials()[surface.point.material].shader.get();
    const bool passes = shader != nullptr && shader->transparency;
    return passes ? glm::max(color(surface, *shader->transparency), Rgb(0)) : Rgb(0);
}

void CameraSurfaces::find_lobes(const Surface& surface, std::vector<SurfaceLobe>& lobes) const {
    lobes.clear();
    if (const SurfaceShader* shader = scene_->materials()[surface.point.material].shader.get()) {
        for (const ShadedLobe& lobe : shader->lobes) {
            const LobeShape shape =
                lobe.alpha ? with_width(lobe.shape, double{width(surface, *lobe.alpha)}) : lobe.shape;
            const bool known = !lobes.empty() && lobe.normal == (&lobe - 1)->normal;
            const Vec3d own = known ? lobes.back().normal : normal(surface, lobe);
            lobes.push_back({shape, own, color(surface, lobe.weight), lobe.several_bounces});
        }
        return;
    }
    const Vec3d& normal = surface.point.shading_normal;
    const float cosine = view_cosine(normal, surface.towards_viewer);
    for (const Lobe& lobe : materials_[surface.point.material].lobes()) {
        lobes.push_back({lobe.shape, normal, lobe.scale(cosine)});
    }
}

/// One hit for each normal that lobes have, and another for the lobes of bumps, whose view is the smooth normal.
void CameraSurfaces::add_hit(const CameraRay& ray, const Surface& surface, Hits& hits) {
    if (surface.depth > transparent_bounces_) {
        return;
    }
    find_lobes(surface, lobes_);
    taken_.assign(lobes_.size(), 0);
    const Terminator terminator = scene_->placed().terminator(surface.hit, surface.point);
    for (std::size_t first = 0; first < lobes_.size(); ++first) {
        if (taken_[first] != 0) {
            continue;
        }
        const SurfaceLobe& own = lobes_[first];
        const bool bumped = is_bumped(own);
        weights_.assign(lobes_.size(), Rgb(0));
        widths_.assign(lobes_.size(), 1);
        for (std::size_t i = first; i < lobes_.size(); ++i) {
            if (lobes_[i].normal == own.normal && is_bumped(lobes_[i]) == bumped) {
                taken_[i] = 1;
                if (!is_mirror(lobes_[i].shape)) {
                    weights_[i] = surface.throughput * lobes_[i].weight;
                    widths_[i] = static_cast<float>(lobe_width(lobes_[i].shape));
                }
            }
        }
        if (std::ranges::any_of(weights_, [](const Rgb& weight) { return weight != Rgb(0); })) {
            const Vec3d& view = bumped ? surface.point.shading_normal : surface.towards_viewer;
            const ShadingFrame frame = shading_frame(surface.point.position, own.normal, view);
            hits.add(surface.point, terminator, frame, view_cosine(frame.z, view), weights_, widths_, ray.sample);
        }
    }
}

}  // namespace shlight
