// SPDX-License-Identifier: MIT
//
// Where the paths of CameraSurfaces go below a surface, and where they leave it.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "lobes/refraction.h"
#include "shlight/sampling.h"
#include "surfaces/camera_surfaces.h"

namespace shlight {
namespace {

/// Seed of what is drawn below surfaces, beside the seeds of lobes.
constexpr std::uint32_t kSubsurfaceSeed = 0x40000000U;
/// The probability of each axis of a probe: the normal, and two across.
constexpr std::array<double, 3> kAxisShares = {0.5, 0.25, 0.25};
/// The radius at which the diffusion profile ends, in units of its d, and the share of it up to there.
constexpr double kProfileEnd = 16;
const double kProfileShare = 1 - 0.25 * std::exp(-kProfileEnd) - 0.75 * std::exp(-kProfileEnd / 3);

/// The radius within which a share of the profile lies, in units of d: 1 - e^(-r)/4 - 3 e^(-r/3)/4 is a cubic
/// polynomial of e^(-r/3) (Golubev 2019, "Efficient Screen-Space Subsurface Scattering Using Burley's Normalized
/// Diffusion").
double profile_radius(double share) {
    return -3 * std::log(2 * std::sinh(std::asinh(2 * (1 - share * kProfileShare)) / 3));
}

/// Christensen & Burley 2015, Eq. 3, times 2 pi r, of each channel. inverse: of d.
Rgb burley_profile(const Rgb& inverse, double radius) {
    Rgb result(0);
    for (int i = 0; i < 3; ++i) {
        const double r = radius * double{inverse[i]};
        result[i] = r < kProfileEnd ? static_cast<float>(0.25 * (std::exp(-r) + std::exp(-r / 3))) * inverse[i] : 0.0F;
    }
    return result;
}

}  // namespace

void CameraSurfaces::enter_bodies(std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
        const SurfaceShader* shader = scene_->materials()[surfaces_[i].point.material].shader.get();
        if (shader == nullptr || !reflects(surfaces_[i]) || surfaces_[i].diffused || surfaces_[i].exit_lobe) {
            continue;
        }
        for (std::uint32_t lobe = 0; lobe < shader->lobes.size(); ++lobe) {
            const auto& below = shader->lobes[lobe].subsurface;
            if (below && below->entry != SubsurfaceEntry::exit_only) {
                enter_body(i, lobe);
            }
        }
    }
}

void CameraSurfaces::enter_body(std::size_t number, std::uint32_t lobe) {
    const Surface& surface = surfaces_[number];
    const ShadedLobe& own = scene_->materials()[surface.point.material].shader->lobes[lobe];
    const std::uint32_t numbers = own.subsurface->numbers;
    const Rgb extinction = color(surface, numbers);
    const Rgb throughput = surface.throughput * color(surface, own.weight) * color(surface, numbers + 6) *
                           Rgb(glm::greaterThan(extinction, Rgb(0)));
    if (throughput == Rgb(0)) {
        return;
    }
    const std::uint32_t seed = hash(rays_[surface.ray].seed, hash(surface.bounces, kSubsurfaceSeed + lobe));
    const std::uint32_t sample = rays_[surface.ray].sample;
    if (own.subsurface->entry == SubsurfaceEntry::disk) {
        probe_body(number, lobe, extinction, throughput, SobolSequence(seed).point(sample));
        return;
    }
    const ShadingFrame frame =
        shading_frame(surface.point.position, normal(surface, own.normal), surface.towards_viewer);
    const Vec3d way = frame.to_world(way_below(surface, *own.subsurface, frame, SobolSequence(seed).point(sample)));
    const Vec3d& flat = surface.point.geometric_normal;
    if (glm::dot(way, flat) >= 0) {
        return;
    }
    const Ray ray = {Vec3f(surface.point.position - surface.point.error * flat), 0, Vec3f(way), Ray().t_max, kAllRays};
    const double anisotropy = std::clamp(double{result(surface, numbers + 11)}, -0.99, 0.99);
    walks_.push_back({number,
                      lobe,
                      surface.hit.instance,
                      hash(seed, sample),
                      sobol_beyond(sample, seed),
                      {extinction, color(surface, numbers + 3), anisotropy},
                      ray,
                      throughput});
}

Vec3d CameraSurfaces::way_below(const Surface& surface, const ShadedSubsurface& own, const ShadingFrame& frame,
                                glm::dvec2 point) const {
    const bool is_skin = own.entry == SubsurfaceEntry::skin;
    if (own.entry == SubsurfaceEntry::diffuse || (is_skin && point.x < 0.5)) {
        point.x *= is_skin ? 2 : 1;
        return -sample_lobe(LambertShape{}, Vec3d(0, 0, 1), point);
    }
    point.x = is_skin ? 2 * point.x - 1 : point.x;
    const double alpha = is_skin ? 1.0 : double{width(surface, own.numbers + 9)};
    const double cosine = view_cosine(frame.z, surface.towards_viewer);
    const Vec3d view(std::sqrt(1 - cosine * cosine), 0, cosine);
    const double ior = result(surface, own.numbers + 10);
    return sample_interface({alpha, ior, InterfaceReflection::none}, view, point, 0).way;
}

/// Along the normal or across, so that curved surfaces are found, too (King et al. 2013, "BSSRDF Importance Sampling").
void CameraSurfaces::probe_body(std::size_t number, std::uint32_t lobe, const Rgb& inverse, const Rgb& throughput,
                                glm::dvec2 point) {
    const SurfacePoint& from = surfaces_[number].point;
    // It matters where surfaces bend how the axes lie; these are the axes that Cycles takes.
    const ShadingFrame own = shading_frame(from.position, from.geometric_normal, Vec3d(1));
    SubsurfaceProbe probe = {number, lobe, 0, {own.z, own.x, own.y}, {}, inverse, throughput, 0};
    for (; point.y >= kAxisShares[probe.axis] && probe.axis < 2; ++probe.axis) {
        point.y -= kAxisShares[probe.axis];
    }
    std::array<double, 3> known{};
    std::size_t count = 0;
    for (int i = 0; i < 3; ++i) {
        if (inverse[i] > 0) {
            known[count++] = 1 / double{inverse[i]};
        }
    }
    const double place = point.x * static_cast<double>(count);
    const auto channel = std::min(static_cast<std::size_t>(place), count - 1);
    probe.radius = known[channel] * profile_radius(place - static_cast<double>(channel));
    const double end = kProfileEnd * known[channel];
    const double half = std::sqrt(std::max(end * end - probe.radius * probe.radius, 0.0));
    const double azimuth = 2 * std::numbers::pi * point.y / kAxisShares[probe.axis];
    const Vec3d& up = probe.axes[probe.axis];
    const Vec3d across =
        std::cos(azimuth) * probe.axes[(probe.axis + 1) % 3] + std::sin(azimuth) * probe.axes[(probe.axis + 2) % 3];
    probe.ray = {Vec3f(from.position + half * up + probe.radius * across), 0, Vec3f(-up), static_cast<float>(2 * half),
                 kAllRays};
    probe.throughput *= static_cast<float>(count);
    probes_.push_back(probe);
}

void CameraSurfaces::leave_bodies() {
    walk_below(scene_->rays(), walks_);
    for (const SubsurfaceWalk& walk : walks_) {
        if (!walk.exit.missed()) {
            leave_body(walk.surface, walk.lobe, walk.exit, Vec3d(walk.ray.direction), walk.throughput);
        }
    }
    walks_.clear();
    while (!probes_.empty()) {
        std::vector<Ray> rays;
        std::vector<std::uint32_t> instances;
        for (const SubsurfaceProbe& probe : probes_) {
            rays.push_back(probe.ray);
            instances.push_back(surfaces_[probe.surface].hit.instance);
        }
        met_.resize(rays.size());
        intersect_instances(scene_->rays(), rays, instances, met_);
        std::vector<SubsurfaceProbe> rest;
        for (std::size_t i = 0; i < probes_.size(); ++i) {
            if (!met_[i].missed()) {
                leave_probe(probes_[i], met_[i]);
                rest.push_back(probes_[i]);
                rest.back().ray = behind(probes_[i].ray, met_[i]);
            }
        }
        probes_ = std::move(rest);
    }
}

void CameraSurfaces::leave_probe(const SubsurfaceProbe& probe, const RayHit& hit) {
    const Surface& from = surfaces_[probe.surface];
    const SurfacePoint point = scene_->placed().surface(hit, probe.ray.direction);
    double squares = 0;
    double chosen = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const double density = kAxisShares[i] * std::abs(glm::dot(probe.axes[i], point.geometric_normal));
        squares += density * density;
        chosen = i == probe.axis ? density : chosen;
    }
    const Rgb drawn = burley_profile(probe.inverse, probe.radius);
    const Rgb light = burley_profile(probe.inverse, glm::distance(point.position, from.point.position));
    const float density = drawn.x + drawn.y + drawn.z;
    if (!(density > 0 && squares > 0)) {
        return;
    }
    const bool is_back = scene_->placed().is_back(hit, point.geometric_normal);
    const double side = is_back == scene_->placed().is_back(from.hit, from.point.geometric_normal) ? 1 : -1;
    leave_body(probe.surface, probe.lobe, hit, side * point.geometric_normal,
               probe.throughput * light * static_cast<float>(chosen / squares) / density);
}

void CameraSurfaces::leave_body(std::size_t number, std::uint32_t lobe, const RayHit& hit, const Vec3d& way,
                                const Rgb& throughput) {
    Surface end = surfaces_[number];
    const std::uint32_t material = end.point.material;
    // The path goes on as if its ray had come from outside.
    end.point = scene_->placed().surface(hit, Vec3f(-way));
    end.point.material = material;
    end.hit = hit;
    end.towards_viewer = glm::normalize(way);
    end.throughput = throughput;
    end.source = RaySource::scattered;
    end.exit_lobe = lobe;
    surfaces_.push_back(end);
}

void CameraSurfaces::find_exit_lobes(const Surface& surface, const SurfaceShader& shader,
                                     std::vector<SurfaceLobe>& lobes) const {
    const ShadedLobe& exit = shader.lobes[*surface.exit_lobe];
    const Vec3d own = normal(surface, exit.normal);
    bool is_part = false;
    for (const ShadedLobe& lobe : shader.lobes) {
        const bool is_exit = &lobe == &exit;
        const bool has_entry = lobe.subsurface && lobe.subsurface->entry != SubsurfaceEntry::exit_only;
        is_part = has_entry ? is_exit : is_part;
        Rgb weight(is_exit ? 1.0F : 0.0F);
        if (is_part && lobe.subsurface && !has_entry) {
            weight = color(surface, lobe.weight) / glm::max(color(surface, exit.weight), Rgb(1e-30F));
        }
        const bool leans = is_bumped(lobe.shape) && weight != Rgb(0);
        const Vec3d before = leans || lobe.leans_from ? leaning(surface, lobe, own) : Vec3d(0);
        lobes.push_back({lobe.shape, own, weight, false, false, leans ? before : Vec3d(0), before});
    }
}

}  // namespace shlight
