// SPDX-License-Identifier: MIT
#include "render/camera_surfaces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace shlight {
namespace {

/// Normals that differ by less are those of floats and doubles of the same surface.
constexpr double kSameNormal = 1e-6;

bool is_bumped(const ShadedLobe& lobe) {
    const auto* diffuse = std::get_if<DiffuseShape>(&lobe.shape);
    return diffuse != nullptr && diffuse->kind == Diffuse::bumped;
}

constexpr float kLeastWidth = kLeastRoughness * kLeastRoughness;

/// Reads the inputs of one material's program.
class PlaceReader : public ShaderReader {
  public:
    PlaceReader(const CompiledScene& scene, const Material& material, std::span<const ShadedPlace> places)
        : scene_(&scene), material_(&material), places_(places) {}

    void read(const ShaderInput& input, int place, std::size_t first, std::span<float> out) const override {
        scene_->read(input, *material_, place, places_.subspan(first, out.size()), out);
    }

  private:
    const CompiledScene* scene_;
    const Material* material_;
    std::span<const ShadedPlace> places_;
};

}  // namespace

void CameraSurfaces::trace(std::span<const CameraRay> rays, std::span<const NeighbourRays> neighbours,
                           std::size_t rays_per_pixel, Hits& hits, std::vector<RayLight>& light) {
    surfaces_.clear();
    results_.clear();
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
        const SurfacePoint point = scene_->surface(met_[i], segment.whole.direction);
        const Vec3d direction = glm::normalize(Vec3d(segment.whole.direction));
        const double distance = glm::dot(point.position - Vec3d(segment.whole.origin), direction);
        add_lamps(viewer, segment, parts_[i], distance, sink);
        surfaces_.push_back({segment.ray, segment.is_mirrored, segment.depth, segment.whole, met_[i], point, -direction,
                             distance, distance - segment.whole.t_min, segment.throughput, 0, 0});
    }
    segments_.clear();
    parts_.clear();
}

ShadedPlace CameraSurfaces::place_of(const Surface& surface, const NeighbourRays* neighbours) const {
    ShadedPlace place = {
        {}, surface.point.shading_normal, surface.point.geometric_normal, surface.ray_length, surface.depth};
    place.at.fill({surface.hit, surface.point.position, surface.towards_viewer});
    if (neighbours != nullptr) {
        const Vec3d& normal = surface.point.geometric_normal;
        place.at[1] = scene_->neighbour(place.at[0], normal, surface.distance, neighbours->right);
        place.at[2] = scene_->neighbour(place.at[0], normal, surface.distance, neighbours->below);
    }
    return place;
}

void CameraSurfaces::leave_scene(const Segment& segment, const Sink& sink) {
    const Environment* background = segment.is_mirrored ? &scene_->environment() : scene_->background();
    const Rgb& left = segment.throughput;
    const Vec3d direction = glm::normalize(Vec3d(segment.whole.direction));
    if (background != nullptr) {
        add_light(segment.ray, segment.is_mirrored, LightKind::environment, scene_->environment_group(),
                  left * background->radiance(direction), sink);
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
    if (!scene_->shows_lamps(viewer)) {
        return;
    }
    by_group_.assign(sink.apart.empty() ? 0 : sink.apart.parts().count - kLightKinds, Rgb(0));
    const Rgb radiance = scene_->lamps_along(viewer, part, surface, by_group_);
    sink.light[segment.ray].radiance += segment.throughput * radiance;
    for (std::size_t group = 0; group < by_group_.size(); ++group) {
        sink.apart.add(segment.ray / sink.rays_per_pixel, segment.is_mirrored ? LightKind::glossy : LightKind::emission,
                       static_cast<std::uint32_t>(group), segment.throughput * by_group_[group]);
    }
}

void CameraSurfaces::add_light(std::size_t ray, bool is_mirrored, LightKind kind, std::uint32_t group,
                               const Rgb& radiance, const Sink& sink) {
    sink.light[ray].radiance += radiance;
    if (!sink.apart.empty() && radiance != Rgb(0)) {  // groups without light have no part
        sink.apart.add(ray / sink.rays_per_pixel, is_mirrored ? LightKind::glossy : kind, group, radiance);
    }
}

void CameraSurfaces::run_programs(std::span<const NeighbourRays> neighbours, std::size_t first) {
    order_.clear();
    for (std::size_t i = first; i < surfaces_.size(); ++i) {
        const SurfaceShader* shader = scene_->materials()[surfaces_[i].point.material].shader.get();
        if (shader != nullptr && (!surfaces_[i].is_mirrored || shader->transparency)) {
            order_.push_back(static_cast<std::uint32_t>(i));
        }
    }
    const auto material = [&](std::uint32_t i) { return surfaces_[i].point.material; };
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return material(a) < material(b); });
    for (auto begin = order_.begin(); begin != order_.end();) {
        const auto end =
            std::find_if(begin, order_.end(), [&](std::uint32_t i) { return material(i) != material(*begin); });
        run_program(neighbours, {begin, end});
        begin = end;
    }
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
    program.evaluate(PlaceReader(*scene_, material, places_), surfaces.size(), program.takes_differences(), registers_,
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
    const Rgb emission = by_program ? color(surface, *material.shader->emission) : material.emission;
    add_light(surface.ray, surface.is_mirrored, LightKind::emission, material.group, surface.throughput * emission,
              sink);
}

/// Emission of the surfaces met last, and the paths that go on from there.
void CameraSurfaces::pass_on(std::size_t first, const Sink& sink) {
    for (std::size_t i = first; i < surfaces_.size(); ++i) {
        const Surface& surface = surfaces_[i];
        if (!surface.is_mirrored) {
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
                start({surface.ray, surface.is_mirrored, surface.depth + 1, throughput, surface.way},
                      behind(surface.way, surface.hit));
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
        const double cosine = view_cosine(frame, surface.towards_viewer);
        const Vec3d direction = frame.to_world(mirrored({std::sqrt(1 - cosine * cosine), 0, cosine}));
        const Ray ray = {Vec3f(surface.point.off_surface()), 0, Vec3f(direction)};
        const auto albedo = static_cast<float>(lobe_albedo(lobe.shape, cosine));
        const Segment segment = {surface.ray, true, 0, surface.throughput * lobe.weight * albedo, ray};
        add_lamps(LampViewer::unblocked_mirror, segment, ray, std::nullopt, sink);
        start(segment, ray);
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
            lobes.push_back({shape, normal(surface, lobe), color(surface, lobe.weight), lobe.several_bounces});
        }
        return;
    }
    const auto cosine = static_cast<float>(glm::dot(surface.point.shading_normal, surface.towards_viewer));
    for (const Lobe& lobe : materials_[surface.point.material].lobes()) {
        lobes.push_back({lobe.shape, surface.point.shading_normal, lobe.scale(cosine)});
    }
}

/// One hit for each normal that lobes have, and another for the lobes of bumps, whose view is the smooth normal.
void CameraSurfaces::add_shaded(const CameraRay& ray, const Surface& surface, const SurfaceShader& shader, Hits& hits) {
    normals_.clear();
    for (std::size_t i = 0; i < shader.lobes.size(); ++i) {
        const bool known = i > 0 && shader.lobes[i].normal == shader.lobes[i - 1].normal;
        normals_.push_back(known ? normals_.back() : normal(surface, shader.lobes[i]));
    }
    const std::size_t count = shader.lobes.size();
    for (std::size_t first = 0; first < count; ++first) {
        const auto shares = [&](std::size_t i) {
            return normals_[i] == normals_[first] && is_bumped(shader.lobes[i]) == is_bumped(shader.lobes[first]);
        };
        std::size_t earlier = 0;
        while (earlier < first && !shares(earlier)) {
            ++earlier;
        }
        if (earlier == first) {
            add_lobes(ray, surface, shader, shares, first, hits);
        }
    }
}

template <class Shares>
void CameraSurfaces::add_lobes(const CameraRay& ray, const Surface& surface, const SurfaceShader& shader,
                               const Shares& shares, std::size_t first, Hits& hits) {
    weights_.assign(shader.lobes.size(), Rgb(0));
    widths_.assign(shader.lobes.size(), 1);
    bool any = false;
    for (std::size_t i = first; i < shader.lobes.size(); ++i) {
        if (shares(i)) {
            const ShadedLobe& lobe = shader.lobes[i];
            weights_[i] = is_mirror(lobe.shape) ? Rgb(0) : surface.throughput * color(surface, lobe.weight);
            widths_[i] = lobe.alpha ? width(surface, *lobe.alpha) : 1.0F;
            any = any || weights_[i] != Rgb(0);
        }
    }
    if (any) {
        const Vec3d& view = is_bumped(shader.lobes[first]) ? surface.point.shading_normal : surface.towards_viewer;
        const ShadingFrame frame = shading_frame(surface.point.position, normals_[first], view);
        hits.add(surface.point, frame, view_cosine(frame, view), weights_, widths_, ray.sample);
    }
}

void CameraSurfaces::add_hit(const CameraRay& ray, const Surface& surface, Hits& hits) {
    if (surface.depth > transparent_bounces_) {
        return;
    }
    const Material& material = scene_->materials()[surface.point.material];
    if (material.shader != nullptr) {
        add_shaded(ray, surface, *material.shader, hits);
        return;
    }
    const std::span<const Lobe> lobes = materials_[surface.point.material].lobes();
    const ShadingFrame frame =
        shading_frame(surface.point.position, surface.point.shading_normal, surface.towards_viewer);
    const float cosine = view_cosine(frame, surface.towards_viewer);
    weights_.clear();
    for (const Lobe& lobe : lobes) {
        weights_.push_back(is_mirror(lobe.shape) ? Rgb(0) : surface.throughput * lobe.scale(cosine));
    }
    hits.add(surface.point, frame, cosine, weights_, {}, ray.sample);
}

}  // namespace shlight
