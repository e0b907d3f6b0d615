// SPDX-License-Identifier: MIT
#include "surfaces/camera_surfaces.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "lobes/refraction.h"

namespace shlight {
namespace {

/// Normals that differ by less are those of floats and doubles of the same surface.
constexpr double kSameNormal = 1e-6;

constexpr float kLeastWidth = kLeastRoughness * kLeastRoughness;

}  // namespace

void CameraSurfaces::trace(std::span<const CameraRay> rays, std::span<const NeighbourRays> neighbours,
                           std::size_t rays_per_pixel, Hits& hits, std::vector<RayLight>& light) {
    rays_ = rays;
    trace({0, RaySource::camera, 0, 0, PathKind::direct, Rgb(1), {}}, neighbours,
          {light, hits.apart, rays_per_pixel, 0, 1}, hits);
}

void CameraSurfaces::trace_scattered(std::span<const CameraRay> rays, std::span<const NeighbourRays> neighbours,
                                     std::size_t rays_per_group, Hits& hits, std::vector<RayLight>& light) {
    rays_ = rays;
    const Sink sink = {light, hits.apart, rays_per_group, 1, settings_.max_bounces};
    Segment beginning = {0, RaySource::scattered, 1, 0, PathKind::diffuse, Rgb(1), {}, kDiffuseRay};
    beginning.diffused = beginning.filtered = true;
    trace(beginning, neighbours, sink, hits);
}

void CameraSurfaces::trace(const Segment& beginning, std::span<const NeighbourRays> neighbours, const Sink& sink,
                           Hits& hits) {
    surfaces_.clear();
    results_.clear();
    hit_count_ = 0;
    mirror_count_ = 0;
    sink.light.assign(rays_.size() * sink.counts, {});
    hits.apart.reset(sink.first_bounces > 0 ? sink.light.size() : rays_.size() / sink.rays_per_pixel);
    segments_.clear();
    parts_.clear();
    met_by_ray_.assign(rays_.size(), 0);
    for (std::size_t i = 0; i < rays_.size(); ++i) {
        if (rays_[i].ray.empty()) {
            continue;  // outside a panorama's image, which is opaque, as Cycles has it
        }
        Segment segment = beginning;
        segment.ray = i;
        segment.whole = rays_[i].ray;
        if (segments_.empty() || segments_.back().whole.origin != segment.whole.origin) {
            segment.absorption = absorption_at(segment.whole);
        } else {
            segment.absorption = segments_.back().absorption;
        }
        start(segment, rays_[i].ray);
    }
    while (!segments_.empty()) {
        const std::size_t first = surfaces_.size();
        meet(sink);
        run_programs(neighbours, first);
        const std::size_t last = surfaces_.size();
        pass_on(first, sink);
        enter_bodies(first, last);
        if (!walks_.empty() || !probes_.empty()) {
            const std::size_t exits = surfaces_.size();
            leave_bodies();
            run_programs(neighbours, exits);
            pass_on(exits, sink);
        }
    }
    add_hits(sink, hits);
}

void CameraSurfaces::start(const Segment& segment, const Ray& part) {
    segments_.push_back(segment);
    parts_.push_back(part);
    parts_.back().kinds = segment.seen_by;
}

/// The next surface of each path, or what lies behind all of them.
void CameraSurfaces::meet(const Sink& sink) {
    met_.resize(parts_.size());
    scene_->rays().intersect(parts_, met_);
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        const Segment& segment = segments_[i];
        const LampViewer viewer = segment.source == RaySource::camera ? LampViewer::camera : LampViewer::mirror;
        if (met_[i].missed()) {
            if (segment.sees_lights()) {
                add_lamps(viewer, segment, parts_[i], std::nullopt, sink);
                leave_scene(segment, sink);
            }
            continue;
        }
        const SurfacePoint point = scene_->placed().surface(met_[i], segment.whole.direction);
        const Vec3d direction = glm::normalize(Vec3d(segment.whole.direction));
        const double distance = glm::dot(point.position - Vec3d(segment.whole.origin), direction);
        if (segment.sees_lights()) {
            // Directions are drawn to lamps that stand in the surface, too.
            const double reach = std::isinf(segment.density) ? 0.0 : 2 * point.error;
            add_lamps(viewer, segment, parts_[i], distance + reach, sink);
        }
        Surface end = {segment, met_[i], point, -direction, distance, cover(met_[i], point, -direction), 0, 0};
        if (segment.source == RaySource::camera && scene_->placed().is_holdout(met_[i])) {
            end.source = RaySource::held_out;
        }
        absorb(end, distance - double{parts_[i].t_min});
        if (segment.is_broad && reflects(end) && add_cell(end, sink)) {
            add_emission(end, sink);
        } else {
            surfaces_.push_back(end);
            ++met_by_ray_[end.ray];
        }
    }
    segments_.clear();
    parts_.clear();
}

/// Neighbours of other rays than the camera's are unknown; places near by, and the directions to them, are Cycles'.
PlacesBeside CameraSurfaces::places_beside(const SurfacePlace& place, const Surface& surface,
                                           const NeighbourRays& neighbours, double slope_width) const {
    PlacesBeside beside{place, place, place, place};
    const PlacedMeshes& placed = scene_->placed();
    const Vec3d& normal = surface.point.geometric_normal;
    if (surface.source == RaySource::camera) {
        beside[0] = placed.neighbour(place, normal, surface.distance, neighbours.right);
        beside[1] = placed.neighbour(place, normal, surface.distance, neighbours.below);
    }
    if (slope_width > 0) {
        const double pixel = neighbours.width + neighbours.spread * (surface.travelled + surface.distance);
        const Vec3d diagonal(normal.x == normal.y && normal.x == normal.z ? -1 : 1, 1, 1);
        const Vec3d x = glm::normalize(glm::cross(diagonal, normal));
        beside[2] = placed.beside(place, slope_width * pixel * x);
        beside[3] = placed.beside(place, slope_width * pixel * glm::cross(normal, x));
    }
    return beside;
}

void CameraSurfaces::leave_scene(const Segment& segment, const Sink& sink) {
    const bool is_mirrored = segment.source == RaySource::mirror;
    const Environment& seen = is_mirrored ? scene_->environment() : scene_->background();
    const Rgb light = segment.throughput * seen.radiance(glm::normalize(Vec3d(segment.whole.direction)));
    if (is_mirrored || scene_->background_visible()) {
        add_light(segment, LightKind::environment, scene_->environment_group(), light, sink);
        return;
    }
    if (!sink.apart.empty()) {
        sink.apart.add(sink.in_apart(segment, segment.bounces), LightKind::environment, light);
    }
    leave_empty(segment, segment.throughput, sink);
}

void CameraSurfaces::add_lamps(LampViewer viewer, const Segment& segment, const Ray& part,
                               const std::optional<double>& surface, const Sink& sink) {
    const VisibleLamps& lamps = scene_->visible_lamps(viewer);
    if (lamps.empty()) {
        return;
    }
    by_group_.assign(sink.apart.empty() ? 0 : sink.apart.parts().count - kLightKinds, Rgb(0));
    const Rgb radiance = lamps.radiance(part, surface, segment.light_set, by_group_, segment.density);
    const Rgb throughput = kept(segment, segment.throughput * radiance) * segment.throughput;
    sink.add(segment, segment.emitted_bounces(), throughput * radiance);
    for (std::size_t group = 0; group < by_group_.size(); ++group) {
        sink.apart.add(sink.in_apart(segment, segment.emitted_bounces()), segment.met(LightKind::emission),
                       static_cast<std::uint32_t>(group), throughput * by_group_[group]);
    }
}

void CameraSurfaces::add_light(const Segment& segment, LightKind kind, std::uint32_t group, const Rgb& whole,
                               const Sink& sink) const {
    const std::uint32_t bounces = segment.emitted_bounces();
    const Rgb radiance = kept(segment, whole) * whole;
    sink.add(segment, bounces, radiance);
    if (!sink.apart.empty() && radiance != Rgb(0)) {  // groups without light have no part
        sink.apart.add(sink.in_apart(segment, bounces), segment.met(kind), group, radiance);
    }
}

void CameraSurfaces::run_programs(std::span<const NeighbourRays> neighbours, std::size_t first) {
    order_.clear();
    material_of_.resize(surfaces_.size());
    for (std::size_t i = first; i < surfaces_.size(); ++i) {
        material_of_[i] = surfaces_[i].point.material;
        const SurfaceShader* shader = scene_->materials()[material_of_[i]].shader.get();
        if (surfaces_[i].exit_lobe && !shader->lobes[*surfaces_[i].exit_lobe].normal) {
            continue;  // nothing of it is needed
        }
        if (shader != nullptr && (is_shaded(surfaces_[i]) || shader->transparency || shader->emission)) {
            order_.push_back(static_cast<std::uint32_t>(i));
        }
    }
    for_each_run(order_, material_of_, [&](auto surfaces) { run_program(neighbours, surfaces); });
}

void CameraSurfaces::run_program(std::span<const NeighbourRays> neighbours, std::span<const std::uint32_t> surfaces) {
    const Material& material = scene_->materials()[surfaces_[surfaces.front()].point.material];
    const ShaderProgram& program = material.shader->program;
    const auto differ = [&](std::uint32_t i) {
        return program.slope_width() > 0 || (program.takes_differences() && surfaces_[i].source == RaySource::camera);
    };
    const bool differs = !neighbours.empty() && std::ranges::any_of(surfaces, differ);
    places_.clear();
    beside_.clear();
    for (const std::uint32_t i : surfaces) {
        const Surface& surface = surfaces_[i];
        places_.emplace_back(surface.point, surface.hit, surface.towards_viewer, surface.ray_length(), surface.depth);
        if (differs) {
            const double width{program.slope_width()};
            beside_.push_back(places_beside(places_.back().at, surface, neighbours[surface.ray], width));
        }
    }
    const std::size_t begin = results_.size();
    results_.resize(begin + program.result_count() * surfaces.size());
    scene_->placed().run(program, material, places_, beside_, registers_, std::span(results_).subspan(begin));
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
    if (!surface.sees_lights()) {
        return;
    }
    const Material& material = scene_->materials()[surface.point.material];
    const bool by_program = material.shader != nullptr && surface.source == RaySource::camera;
    const bool is_left_out = surface.light_set && !material.links.lights(*surface.light_set);
    if (is_left_out || (by_program && !material.shader->emission)) {
        return;
    }
    // The program's emission is what the camera sees; other surfaces are lit by the material's.
    const Rgb emission = by_program ? color(surface, *material.shader->emission)
                                    : scene_->placed().emission(material, surface.hit, surface.towards_viewer);
    add_light(surface, LightKind::emission, material.group, surface.throughput * emission, sink);
}

/// Emission of the surfaces met last, and the paths that go on from there.
void CameraSurfaces::pass_on(std::size_t first, const Sink& sink) {
    const std::size_t last = surfaces_.size();
    for (std::size_t i = first; i < last; ++i) {
        const Surface& surface = surfaces_[i];
        if (surface.exit_lobe) {
            reflect(surface, sink);
            continue;
        }
        hit_count_ += surface.source == RaySource::camera && surface.depth == 0 ? 1 : 0;
        add_emission(surface, sink);
        const bool ends = surface.depth > settings_.transparent_bounces;
        const Rgb throughput = ends ? Rgb(0) : surface.throughput * transparency(surface);
        if (throughput != Rgb(0) && passes_crowd(surface)) {
            Segment beyond = static_cast<const Segment&>(surface);
            ++beyond.depth;
            beyond.source = surface.source == RaySource::held_out ? RaySource::camera : surface.source;
            beyond.throughput = throughput / share_in_crowd(surface);
            beyond.absorption = surface.absorption_beyond;
            start(beyond, behind(surface.whole, surface.hit));
        }
        if (surface.source == RaySource::held_out) {
            leave_empty(surface, surface.throughput - throughput, sink);
        } else if (reflects(surface)) {
            reflect(surface, sink);
        } else if (surface.cover == Cover::by_rounding && is_shaded(surface)) {
            leave_gap(i, sink);
        }
    }
}

ShadingFrame CameraSurfaces::frame_of(const Surface& surface, const SurfaceLobe& lobe) const {
    return shading_frame(surface.point.position, lobe.normal, view_of(surface, lobe));
}

void CameraSurfaces::add_hits(const Sink& sink, Hits& hits) {
    hits.clear();
    hit_paths_.clear();
    order_.resize(surfaces_.size());
    std::iota(order_.begin(), order_.end(), 0U);
    std::erase_if(order_, [&](std::uint32_t i) { return !reflects(surfaces_[i]); });
    const auto ray_of = [&](std::uint32_t i) { return surfaces_[i].ray; };
    if (!std::ranges::is_sorted(order_, {}, ray_of)) {
        std::ranges::stable_sort(order_, {}, ray_of);
    }
    auto next = order_.begin();
    for (std::size_t end = sink.rays_per_pixel; end <= rays_.size(); end += sink.rays_per_pixel) {
        for (; next != order_.end() && surfaces_[*next].ray < end; ++next) {
            add_hit(surfaces_[*next], sink, hits);
            hit_paths_.resize(hits.size(), {surfaces_[*next].is_drawn, surfaces_[*next].chance});
        }
        hits.end_pixel();
    }
}

Vec3d CameraSurfaces::normal(const Surface& surface, const std::optional<std::uint32_t>& result) const {
    const Vec3d& smooth = surface.point.shading_normal;
    if (!result) {
        return smooth;
    }
    const Vec3d own = vector(surface, *result);
    const double length = glm::length(own);
    const bool differs = length > 0 && std::isfinite(length) && glm::distance(own / length, smooth) > kSameNormal;
    return differs ? own / length : smooth;
}

Rgb CameraSurfaces::transparency(const Surface& surface) const {
    const SurfaceShader* shader = scene_->materials()[surface.point.material].shader.get();
    const bool passes = shader != nullptr && shader->transparency;
    return passes ? glm::max(color(surface, *shader->transparency), Rgb(0)) : Rgb(0);
}

/// Returns the index of what is behind ÷ that of the viewer's side.
double CameraSurfaces::ior(const Surface& surface, const ShadedRefraction& refraction) const {
    const float given = result(surface, refraction.ior);
    const double ior = given > 0 && std::isfinite(given) ? double{given} : 1.0;
    return scene_->placed().is_back(surface.hit, surface.towards_viewer) ? 1 / ior : ior;
}

Rgb CameraSurfaces::refracted(const Surface& surface) const {
    Rgb sum(0);
    if (const SurfaceShader* shader = scene_->materials()[surface.point.material].shader.get()) {
        for (const ShadedRefraction& own : shader->refractions) {
            const double cosine = view_cosine(normal(surface, own.normal), surface.towards_viewer);
            const double reflected = interface_reflectance(cosine, ior(surface, own));
            const double passed = own.reflects || reflected >= 1 ? 1 - reflected : 1.0;
            sum += static_cast<float>(passed) * color(surface, own.weight);
        }
    }
    return sum;
}

LobeShape CameraSurfaces::laid_out(const Surface& surface, const LobeShape& shape) const {
    if (!is_anisotropic(shape)) {
        return shape;
    }
    const ShadingFrame frame =
        shading_frame(surface.point.position, surface.point.shading_normal, surface.towards_viewer);
    return with_azimuth(shape, scene_->placed().azimuth(surface.hit, frame));
}

LobeShape CameraSurfaces::varied(const Surface& surface, const ShadedLobe& lobe, const Vec3d& normal) const {
    LobeForm form{width(surface, *lobe.alpha)};
    if (has_two_widths(lobe.shape)) {
        form.across = width(surface, *lobe.alpha + 1);
    }
    if (is_stretched(lobe.shape)) {
        const ShadingFrame frame = shading_frame(surface.point.position, normal, surface.towards_viewer);
        const Vec3d tangent = vector(surface, *lobe.alpha + 2);
        const double x = glm::dot(tangent, frame.x);
        const double y = glm::dot(tangent, frame.y);
        const double turn = std::isfinite(x) && std::isfinite(y) ? std::atan2(-y, x) : 0.0;
        form.azimuth = static_cast<float>(turn);
        if (form.width > form.across) {
            std::swap(form.width, form.across);
            form.azimuth -= static_cast<float>(std::numbers::pi / 2);
        }
    }
    return with_form(lobe.shape, surface.filtered ? widened(lobe.shape, form, settings_.least_width) : form);
}

Terminator CameraSurfaces::terminator(const Surface& surface, const SurfaceLobe& own, const SurfacePoint& point) const {
    Terminator result = scene_->placed().terminator(surface.hit, point);
    if (own.smooth != Vec3d(0)) {
        result.smooth = glm::dot(own.smooth, point.shading_normal) < 0 ? -own.smooth : own.smooth;
    }
    result.glossy = is_glossy(own.shape);
    return result;
}

/// Cycles' shadow of a bump is the same for a smooth normal and its opposite.
Vec3d CameraSurfaces::leaning(const Surface& surface, const ShadedLobe& lobe, const Vec3d& own) const {
    const Vec3d smooth = normal(surface, lobe.leans_from);
    return glm::dot(smooth, own) < 0 ? -smooth : smooth;
}

void CameraSurfaces::find_lobes(const Surface& surface, std::vector<SurfaceLobe>& lobes) const {
    lobes.clear();
    const Vec3d& smooth = surface.point.shading_normal;
    const float cosine = view_cosine(smooth, surface.towards_viewer);
    if (const SurfaceShader* shader = scene_->materials()[surface.point.material].shader.get()) {
        if (surface.exit_lobe) {
            find_exit_lobes(surface, *shader, lobes);
            return;
        }
        const std::span<const Lobe> fixed = materials_[surface.point.material].lobes();
        for (const ShadedLobe& lobe : shader->lobes) {
            const bool known = !lobes.empty() && lobe.normal == (&lobe - 1)->normal;
            const Vec3d own = known ? lobes.back().viewers_normal() : normal(surface, lobe.normal);
            const LobeShape shape =
                lobe.alpha ? varied(surface, lobe, own) : laid_out(surface, fixed[lobes.size()].shape);
            const float weight = lobe.view_weight != nullptr ? (*lobe.view_weight)(cosine) : 1.0F;
            const bool bumped = is_bumped(shape);
            const Vec3d before = bumped || lobe.leans_from ? leaning(surface, lobe, own) : Vec3d(0);
            // The surface shadows a lobe below it, of which only microfacets that face the viewer show light from
            // above.
            const bool is_seen = glm::dot(own, smooth) >= 0 || lobe.translucent ||
                                 (is_glossy(shape) && glm::dot(own, surface.towards_viewer) > 0);
            lobes.push_back({shape, lobe.translucent ? -own : own,
                             is_seen ? weight * color(surface, lobe.weight) : Rgb(0), lobe.several_bounces,
                             lobe.translucent, bumped ? before : Vec3d(0), before});
        }
        return;
    }
    for (const Lobe& lobe : materials_[surface.point.material].lobes()) {
        lobes.push_back({laid_out(surface, lobe.shape), smooth, lobe.scale(cosine)});
    }
}

void CameraSurfaces::drop_entered(const Surface& surface) {
    const SurfaceShader* shader = scene_->materials()[surface.point.material].shader.get();
    if (shader == nullptr || surface.exit_lobe || surface.diffused) {
        return;
    }
    for (std::size_t i = 0; i < lobes_.size(); ++i) {
        if (const auto& own = shader->lobes[i].subsurface) {
            lobes_[i].weight *= Rgb(glm::lessThanEqual(color(surface, own->numbers), Rgb(0)));
        }
    }
}

/// One hit for each normal that lobes have, and another for the lobes of bumps, whose view is the smooth normal.
void CameraSurfaces::add_hit(const Surface& surface, const Sink& sink, Hits& hits) {
    find_lobes(surface, lobes_);
    drop_entered(surface);
    taken_.assign(lobes_.size(), 0);
    for (std::size_t first = 0; first < lobes_.size(); ++first) {
        if (taken_[first] != 0) {
            continue;
        }
        const SurfaceLobe& own = lobes_[first];
        weights_.assign(lobes_.size(), Rgb(0));
        forms_.assign(lobes_.size(), {});
        for (std::size_t i = first; i < lobes_.size(); ++i) {
            if (lobes_[i].normal == own.normal && lobes_[i].leans_from == own.leans_from) {
                taken_[i] = 1;
                if (!is_mirror(lobes_[i].shape)) {
                    weights_[i] = surface.throughput * lobes_[i].weight;
                    forms_[i] = lobe_form(lobes_[i].shape);
                }
            }
        }
        if (std::ranges::any_of(weights_, [](const Rgb& weight) { return weight != Rgb(0); })) {
            const ShadingFrame frame = frame_of(surface, own);
            const SurfacePoint point = own.lit_side(surface.point);
            hits.add(point, terminator(surface, own, point), frame, view_cosine(frame.z, view_of(surface, own)),
                     weights_, forms_, rays_[surface.ray].sample, surface.kind,
                     static_cast<std::uint32_t>(sink.in_apart(surface, surface.bounces)));
        }
    }
}

}  // namespace shlight
