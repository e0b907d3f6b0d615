// SPDX-License-Identifier: MIT
//
// Where the paths of CameraSurfaces go on.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "lights/shadow_ray_spawner.h"
#include "lobes/refraction.h"
#include "shlight/sampling.h"
#include "surfaces/bump_basis.h"
#include "surfaces/camera_surfaces.h"

namespace shlight {
namespace {

/// A direction of the shading frame's xz-plane.
Vec3d in_frame(double cosine) {
    return {std::sqrt(1 - cosine * cosine), 0, cosine};
}

PathKind kind_of(const LobeShape& lobe) {
    return is_glossy(lobe) ? PathKind::glossy : PathKind::diffuse;
}

double average(const Rgb& color) {
    return double{std::abs(color.x) + std::abs(color.y) + std::abs(color.z)} / 3;
}

/// Share of light from the mirrored direction that a lobe reflects: about its albedo, without an integral.
double mirrored_share(const LobeShape& shape, double cosine) {
    const Vec3d view = in_frame(cosine);
    const Vec3d way = mirrored(view);
    const double density = lobe_density(sampled_shape(shape), view, way);
    return density > 0 ? lobe_value(shape, way, view) / density : 0.0;
}

/// Share of what a path meets that reaches the camera, below which it is not always followed.
constexpr float kSurelyFollowed = 0.25F;
constexpr float kSurelyFollowedToCells = 0.02F;
/// Surfaces that a ray's paths have met from which on fewer of them go on.
constexpr float kCrowd = 16;
/// The least share of light for which two paths share a broad lobe.
constexpr double kShared = 0.04;
/// The density ÷ the filter of a direction in which Cycles would widen lobes to about half as much as by a filter of 0.
constexpr double kFiltered = 0.75;
/// Width of an interface whose rays differ by their side alone.
constexpr double kSmooth = 1e-3;
/// 1 ± this of an index, whose rays go straight on at any roughness.
constexpr double kNoBend = 1e-3;
/// The least Segment::chance of an interface: microfacets may let through what a smooth surface would reflect.
constexpr double kLeastChance = 0.01;
/// Lamps that each path looks at.
constexpr std::size_t kMostLamps = 4;
/// Seeds of directions through interfaces, beside those of lobes, and of those to lamps.
constexpr std::uint32_t kRefractionSeed = 0x80000000U;
constexpr std::uint32_t kLampSeed = 0x40000000U;
/// Seed of paths that surfaces let pass.
constexpr std::uint32_t kPassSeed = 0xC0000000U;

}  // namespace

void CameraSurfaces::reflect(const Surface& surface, const Sink& sink) {
    if (const SurfaceShader* shader = scene_->materials()[surface.point.material].shader.get();
        shader != nullptr && settings_.max_bounces > 0 && !surface.exit_lobe) {
        for (std::uint32_t i = 0; i < shader->refractions.size(); ++i) {
            refract(surface, shader->refractions[i], i, sink);
        }
    }
    const auto lobes = materials_[surface.point.material].lobes();
    const bool goes_on = surface.bounces < settings_.max_bounces;
    if (!goes_on && std::none_of(lobes.begin(), lobes.end(), [](const Lobe& lobe) { return is_mirror(lobe.shape); })) {
        return;
    }
    find_lobes(surface, lobes_);
    drop_entered(surface);
    taken_.assign(lobes_.size(), 0);
    for (std::size_t i = 0; i < lobes_.size(); ++i) {
        const SurfaceLobe& lobe = lobes_[i];
        if (lobe.weight == Rgb(0) || taken_[i] != 0) {
            continue;
        }
        if (is_mirror(lobe.shape)) {
            reflect_mirror(surface, lobe, sink);
        } else if (goes_on && settings_.scatters &&
                   (is_glossy(lobe.shape) ? surface.glossy < settings_.glossy_bounces
                                          : !add_recorded(surface, lobe, sink))) {
            scatter(surface, i);
        }
    }
}

void CameraSurfaces::refract(const Surface& surface, const ShadedRefraction& refraction, std::uint32_t number,
                             const Sink& sink) {
    const double share = average(surface.throughput * color(surface, refraction.weight));
    if (share > 0) {
        const std::uint32_t seed = hash(rays_[surface.ray].seed, hash(surface.bounces, kRefractionSeed + number));
        Division paths = division(surface, share, double{width(surface, refraction.alpha)});
        for (; paths.path < paths.paths; ++paths.path) {
            refract(surface, refraction, seed, paths, sink);
        }
    }
}

bool CameraSurfaces::Interface::is_rough() const {
    return shape.alpha > kSmooth && std::abs(shape.ior - 1) > kNoBend;
}

/// A bend of the normal away from the viewer's side of the surface counts as none.
void CameraSurfaces::refract(const Surface& surface, const ShadedRefraction& refraction, std::uint32_t seed,
                             const Division& division, const Sink& sink) {
    const Vec3d bent = normal(surface, refraction.normal);
    const Vec3d& flat = surface.point.geometric_normal;
    const ShadingFrame frame =
        shading_frame(surface.point.position, glm::dot(bent, flat) > 0 ? bent : flat, surface.towards_viewer);
    const InterfaceReflection reflection = !refraction.reflects ? InterfaceReflection::none
                                           : scene_->placed().is_back(surface.hit, surface.towards_viewer)
                                               ? InterfaceReflection::drawn
                                               : InterfaceReflection::apart;
    const double alpha =
        std::max(double{width(surface, refraction.alpha)}, surface.filtered ? settings_.least_width : 0.0);
    const Interface interface = {{alpha, ior(surface, refraction), reflection, refraction.distribution},
                                 frame,
                                 in_frame(view_cosine(frame.z, surface.towards_viewer))};
    const Rgb weight = surface.throughput * color(surface, refraction.weight) / static_cast<float>(division.paths);
    const double passed = reflection == InterfaceReflection::apart
                              ? 1 - interface_reflectance(interface.view.z, interface.shape.ior)
                              : 1.0;
    const auto chance =
        static_cast<float>(std::clamp(passed * average(color(surface, refraction.weight)), kLeastChance, 1.0));
    const std::uint32_t sample = rays_[surface.ray].sample * division.paths + division.path;
    const auto path = [&](bool reflected, const Rgb& share, const Ray& way) {
        return surface
            .next(RaySource::mirror, reflected ? PathKind::glossy : PathKind::transmission, !reflected, share, way)
            .from(scene_->materials()[surface.point.material])
            .drawn(interface.shape.alpha > kSmooth, division.is_broad);
    };
    if (interface.is_rough()) {
        const ShadingFrame behind = shading_frame(surface.point.position, -frame.z, -frame.z);
        add_drawn_lamps(surface, interface, behind, path(false, weight, {}), hash(seed, kLampSeed), sample, sink);
        if (reflection == InterfaceReflection::drawn) {
            add_drawn_lamps(surface, interface, frame, path(true, weight, {}), hash(seed, ~kLampSeed), sample, sink);
        }
    }
    const InterfaceRay sampled = sample_interface(interface.shape, interface.view, SobolSequence(seed).point(sample),
                                                  sobol_beyond(sample, seed).x);
    const Vec3d way = frame.to_world(sampled.way);
    if (!(sampled.weight > 0) || (glm::dot(way, flat) > 0) != sampled.reflected) {
        return;
    }
    const Vec3d origin = sampled.reflected ? surface.point.off_surface() : surface.point.behind_surface();
    const Ray next = {Vec3f(origin), 0, Vec3f(way)};
    // No other light comes this way.
    Segment on = path(sampled.reflected, weight * static_cast<float>(sampled.weight), next);
    on.chance *= chance;
    if (interface.is_rough()) {
        on.density = number_of_draws() * interface_value(interface.shape, interface.view, sampled.way).density;
    }
    start(on, next);
}

double CameraSurfaces::number_of_draws() const {
    const std::size_t lamps = scene_->lights().size();
    return lamps > kMostLamps ? static_cast<double>(lamps) : 1.0;
}

/// Each path draws one lamp where there are many.
void CameraSurfaces::add_drawn_lamps(const Surface& surface, const Interface& interface, const ShadingFrame& frame,
                                     const Segment& path, std::uint32_t seed, std::uint32_t number, const Sink& sink) {
    const std::span<const Light> lamps = scene_->lights();
    const double share = number_of_draws();
    const bool draws = share > 1;
    const auto drawn = static_cast<std::size_t>(sobol_beyond(number, seed).x * static_cast<double>(lamps.size()));
    const std::size_t first = draws ? std::min(drawn, lamps.size() - 1) : 0;
    const bool behind = glm::dot(frame.z, interface.frame.z) < 0;
    const SurfacePoint point = behind ? surface.point.turned() : surface.point;
    const Vec3d origin = point.off_surface();
    for (std::size_t i = first; i < (draws ? first + 1 : lamps.size()); ++i) {
        const LightTraits& traits = traits_of(lamps[i]);
        if (traits.is_surface || !traits.lights_glossy || !traits.links.lights(path.light_set.value_or(0))) {
            continue;
        }
        const auto lamp = drawer_.draw(lamps[i], frame, point.error,
                                       SobolSequence(hash(seed, static_cast<std::uint32_t>(i))).point(number));
        const Vec3d way = lamp ? frame.to_world(lamp->direction) : Vec3d(0);
        if (glm::dot(way, point.geometric_normal) <= 0) {
            continue;
        }
        const InterfaceValue own = interface_value(interface.shape, interface.view, interface.frame.to_local(way));
        // Rays see no lamps without shadows.
        const double part = traits.casts_shadows ? drawn_part(lamps[i], origin, share * own.density) : 1.0;
        Rgb light = path.throughput * lamp->light * static_cast<float>(own.value * part * share);
        if (light != Rgb(0) && traits.casts_shadows) {
            const ShadowRaySpawner spawner(frame, origin, target_offset(lamps[i], frame), traits.links.shadow_rays);
            const Ray ray = spawner.towards(lamp->direction, lamp->distance);
            Rgb visible(1);
            scene_->rays().visibility({&ray, 1}, settings_.transparent_bounces, {&visible, 1});
            light *= visible;
        }
        add_light(path, LightKind::emission, traits.group, light, sink);
    }
}

void CameraSurfaces::reflect_mirror(const Surface& surface, const SurfaceLobe& lobe, const Sink& sink) {
    const ShadingFrame frame = shading_frame(surface.point.position, lobe.normal, surface.towards_viewer);
    const double cosine = view_cosine(frame.z, surface.towards_viewer);
    const Vec3d direction = frame.to_world(mirrored(in_frame(cosine)));
    const Ray ray = {Vec3f(surface.point.off_surface()), 0, Vec3f(direction)};
    const double let_in = scene_->placed().terminator(surface.hit, surface.point).let_in(cosine);
    const auto albedo = static_cast<float>(let_in * lobe_albedo(lobe.shape, cosine));
    const Segment segment =
        surface.next(RaySource::mirror, PathKind::glossy, false, surface.throughput * lobe.weight * albedo, ray)
            .from(scene_->materials()[surface.point.material]);
    add_lamps(LampViewer::unblocked_mirror, segment, ray, std::nullopt, sink);
    start(segment, ray);
    ++mirror_count_;
}

/// Paths of a ray multiply where surfaces scatter them and let them pass too.
float CameraSurfaces::share_in_crowd(const Surface& surface) const {
    const float crowd = static_cast<float>(met_by_ray_[surface.ray]) / kCrowd;
    return surface.source == RaySource::scattered && crowd > 1 ? 1 / (crowd * crowd) : 1.0F;
}

bool CameraSurfaces::passes_crowd(const Surface& surface) const {
    const float share = share_in_crowd(surface);
    if (share == 1) {
        return true;
    }
    const CameraRay& ray = rays_[surface.ray];
    const std::uint32_t place = hash(hash(surface.bounces, surface.hit.triangle), kPassSeed + surface.depth);
    return sobol_beyond(ray.sample, hash(ray.seed, place)).x < double{share};
}

/// A path is cheap where the light at its end is known: a broad lobe has two.
CameraSurfaces::Division CameraSurfaces::division(const Surface& surface, double share, double width) const {
    const bool is_broad = settings_.stored != nullptr && width >= LightCells::kLeastWidth;
    return {is_broad && surface.bounces == 0 && share > kShared ? 2U : 1U, 0, is_broad};
}

void CameraSurfaces::scatter(const Surface& surface, std::size_t first) {
    const SurfaceLobe& own = lobes_[first];
    const double share = average(surface.throughput * own.weight) *
                         mirrored_share(own.shape, view_cosine(own.normal, view_of(surface, own)));
    const std::uint32_t seed = hash(rays_[surface.ray].seed, hash(surface.bounces, static_cast<std::uint32_t>(first)));
    Division paths = division(surface, share, is_glossy(own.shape) ? lobe_width(own.shape) : 1);
    for (; paths.path < paths.paths; ++paths.path) {
        scatter(surface, first, seed, paths);
    }
}

/// A path that brings little is drawn seldom, and counts the more.
void CameraSurfaces::scatter(const Surface& surface, std::size_t first, std::uint32_t seed, const Division& division) {
    const SurfaceLobe& own = lobes_[first];
    const LobeShape sampled = sampled_shape(own.shape);
    const ShadingFrame frame = frame_of(surface, own);
    const Vec3d view = in_frame(view_cosine(frame.z, view_of(surface, own)));
    const std::uint32_t number = rays_[surface.ray].sample * division.paths + division.path;
    const Vec3d way = sample_lobe(sampled, view, SobolSequence(seed).point(number));
    Rgb weight(0);
    for (std::size_t i = first; i < lobes_.size(); ++i) {
        const SurfaceLobe& lobe = lobes_[i];
        if (lobe.normal == own.normal && !is_mirror(lobe.shape) && sampled_shape(lobe.shape) == sampled &&
            lobe.leans_from == own.leans_from) {
            taken_[i] = 1;
            weight += lobe.weight * static_cast<float>(lobe_value(lobe.shape, way, view));
        }
    }
    const Vec3d direction = frame.to_world(way);
    const double density = lobe_density(sampled, view, way);
    const SurfacePoint point = own.lit_side(surface.point);
    if (!(density > 0) || glm::dot(point.geometric_normal, direction) <= 0) {
        return;
    }
    const Terminator lifted = terminator(surface, own, point);
    weight *= surface.throughput * static_cast<float>(lifted.let_in(way.z) / density / division.paths);
    const auto share = static_cast<float>(average(weight));
    const float surely = division.is_broad ? kSurelyFollowedToCells : kSurelyFollowed;
    const float probability = std::min(share / surely, 1.0F) * share_in_crowd(surface);
    if (sobol_beyond(number, seed).x >= double{probability}) {
        return;
    }
    const Vec3d lift = lifted.lifts() ? lifted.share(direction) * lifted.lift : Vec3d(0);
    const Ray scattered = {Vec3f(point.off_surface() + lift), 0, Vec3f(direction)};
    start(surface.next(RaySource::scattered, kind_of(own.shape), own.translucent, weight / probability, scattered)
              .drawn(true, division.is_broad, density < kFiltered * settings_.filter_glossy),
          scattered);
}

bool CameraSurfaces::add_cell(const Surface& end, const Sink& sink) {
    WorldCell key;
    if (!end.filtered && settings_.stored->cells.is_filtered(end.point.material)) {
        return false;
    }
    if (!settings_.stored->cells.find(end.point, end.whole.direction, end.distance, key)) {
        return false;
    }
    const std::span<const Rgb> light = settings_.stored->cells.look_up(key);
    if (light.empty()) {
        return false;
    }
    const std::size_t count = (settings_.max_bounces - end.bounces + 1) * settings_.stored->parts;
    add_stored(end, end.bounces, end.kind, end.throughput, light.first(count), sink);
    return true;
}

void CameraSurfaces::add_stored(const Segment& segment, std::uint32_t bounces, PathKind kind, const Rgb& weight,
                                std::span<const Rgb> light, const Sink& sink) const {
    const std::size_t parts = settings_.stored->parts;
    for (std::size_t first = 0; first < light.size(); first += parts, ++bounces) {
        sink.add(segment, bounces, weight * light[first]);
        if (!sink.apart.empty()) {
            const std::size_t number = sink.in_apart(segment, bounces);
            sink.apart.add(number, indirect_kind(kind), weight * light[first]);
            for (std::uint32_t group = 0; group + 1 < parts; ++group) {
                sink.apart.of(number)[LightParts::of_group(group)] += weight * light[first + 1 + group];
            }
        }
    }
}

bool CameraSurfaces::add_recorded(const Surface& surface, const SurfaceLobe& lobe, const Sink& sink) {
    if (settings_.stored == nullptr) {
        return false;
    }
    // Light that the camera sees is not told apart by bounces.
    const std::uint32_t most = settings_.max_bounces - surface.bounces;
    const std::uint32_t first = sink.first_bounces > 0 ? 0 : most - 1;
    const std::size_t parts = settings_.stored->parts;
    recorded_.assign((most - first) * parts, Rgb(0));
    const std::optional<RecordBasis> bump = bumped_basis(lobe.shape, lobe.normal, lobe.leans_from);
    if (!settings_.stored->records.reflect(lobe.lit_side(surface.point), lobe.normal, bump, first * parts, recorded_)) {
        return false;
    }
    Rgb weight = surface.throughput * lobe.weight;
    if (!bump) {
        const float cosine = view_cosine(lobe.normal, view_of(surface, lobe));
        // Records have no light from below the horizon, and a bump's albedo leaves out what its lobe has there.
        const double above = lobe.is_bumped() ? (1 + double{cosine}) / 2 : 1.0;
        weight *= static_cast<float>(lobe_albedo(lobe.shape, cosine) / above);
    }
    // Light of a record is nowhere negative, which may leave too much of some parts.
    for (std::size_t i = 0; parts > 1 && i < recorded_.size(); i += parts) {
        complete(std::span(recorded_).subspan(i + 1, parts - 1), recorded_[i], parts - 2);
    }
    for (std::size_t i = recorded_.size(); i-- > parts;) {
        recorded_[i] -= recorded_[i - parts];
    }
    add_stored(surface, surface.bounces + first + 1, surface.kind_after(PathKind::diffuse), weight, recorded_, sink);
    return true;
}

}  // namespace shlight
