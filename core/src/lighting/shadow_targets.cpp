// SPDX-License-Identifier: MIT
#include "lighting/shadow_targets.h"

#include <algorithm>
#include <array>
#include <numbers>

#include "environment/map_lookup.h"

namespace shlight {
namespace {

static_assert(kRaysAtOnce % kLightPointLanes == 0 && kRaysAtOnce % kLobeRayLanes == 0);

/// Only a lobe of whose reflected directions more than this share could meet the light takes rays of its own.
constexpr double kLeastShare = 0.1;

/// Further points that are tried where none of the given ones shines on the hit, as one below its horizon does not: the
/// hit would have no ray, from which nothing is known of what blocks the light.
constexpr int kMostDraws = 16;
/// Steps that spread points evenly (the powers of the inverse of the plastic number, Roberts 2018).
const glm::dvec2 kEvenSteps(0.7548776662466927, 0.5698402909980532);

constexpr std::size_t kLookedUpAtOnce = 256;
static_assert(kLookedUpAtOnce % kLookupLanes == 0);

/// Hits share a guided density within this part of its grid's spacing, if the cosine of their normals is larger.
constexpr double kReach = 0.25;
constexpr double kSameDensity = 0.95;

const ProfileView kEven;

/// Elements are written before they are read.
struct PointBuffer {
    alignas(64) std::array<float, kRaysAtOnce> x, y, z, weight;

    LightPointArrays arrays() { return {x.data(), y.data(), z.data(), weight.data()}; }
};

}  // namespace

void DrawnRays::clear() {
    drawn.clear();
    rays.clear();
    visible.clear();
    color.clear();
    spot_color.clear();
    guided.clear();
}

bool LightTarget::add(const Hits& hits, std::size_t hit) {
    const std::size_t index = whole_.size();
    if (seen_.size() == index) {
        seen_.emplace_back();
    }
    const auto rectangle = WholeRectangle::see(*light_, hits.frame[hit], hits.error[hit]);
    if (!rectangle && !seen_[index].look(*light_, hits.frame[hit], hits.error[hit])) {
        return false;
    }
    whole_.push_back(rectangle);
    return true;
}

void LightTarget::aim(const Hits& hits, std::size_t hit, std::size_t index, bool first) {
    frame_ = &hits.frame[hit];
    start_.emplace(*frame_, hits.shadow_origin[hit], target_offset(*light_, *frame_),
                   traits_of(*light_).links.shadow_rays);
    rectangle_ = whole_[index] ? &*whole_[index] : nullptr;
    profile_ = &kEven;
    const auto* mesh = std::get_if<MeshLight>(light_);
    has_faces_ = mesh != nullptr && mesh->faces != nullptr;
    if (has_faces_) {
        face_sampler_.reset(*mesh->faces, *frame_, hits.error[hit]);
    } else if (rectangle_ == nullptr) {
        profile_ = &seen_[index].profile();
        if (first) {
            sampler_.reset(seen_[index]);
        } else {
            sampler_.move(seen_[index]);
        }
    }
}

double LightTarget::solid_angle() const {
    return rectangle_ != nullptr ? double{rectangle_->most_weight}
           : has_faces_          ? face_sampler_.solid_angle()
                                 : sampler_.solid_angle();
}

void LightTarget::draw(const float* u, const float* v, std::uint32_t count, DrawnRays& rays) {
    if (rectangle_ != nullptr) {
        draw_rectangle(u, v, count, rays);
        return;
    }
    const std::size_t before = rays.size();
    for (std::uint32_t i = 0; i < count; ++i) {
        draw_point({u[i], v[i]}, rays);
    }
    for (int i = 1; i <= kMostDraws && rays.size() == before; ++i) {
        draw_point(glm::fract(glm::dvec2(u[0], v[0]) + static_cast<double>(i) * kEvenSteps), rays);
    }
}

void LightTarget::draw_rectangle(const float* u, const float* v, std::uint32_t count, DrawnRays& rays) {
    PointBuffer buffer;
    for (std::uint32_t first = 0; first < count; first += kRaysAtOnce) {
        const std::uint32_t some = std::min(count - first, kRaysAtOnce);
        place_points(*rectangle_, u + first, v + first, some, buffer.arrays());
        push(buffer.arrays(), some, rays);
    }
}

void LightTarget::draw_point(const glm::dvec2& point, DrawnRays& rays) {
    if (has_faces_) {
        if (const auto sample = face_sampler_.sample(point)) {
            push(*sample, rays);
        }
    } else {
        const LightSample sample = sampler_.sample(point);
        push(sample.direction, sample.distance, sample.weight, rays);
    }
}

bool LightTarget::may_meet(const LobeShape& lobe, const Vec3d& view) const {
    return is_glossy(lobe) && solid_angle() * largest_lobe_density(lobe, view) > kLeastShare;
}

void LightTarget::meet(const RayVectors& directions, std::uint32_t count, RayKind /*kind*/, DrawnRays& rays) {
    if (rectangle_ != nullptr) {
        PointBuffer buffer;
        const LightPointArrays points = {directions.x, directions.y, directions.z, buffer.weight.data()};
        meet_rectangle(*rectangle_, *frame_, count, points);
        push(points, count, rays);
        return;
    }
    for (std::uint32_t i = 0; i < count; ++i) {
        const Vec3d direction(directions.x[i], directions.y[i], directions.z[i]);
        if (!(direction.z > 0)) {
            continue;
        }
        if (has_faces_) {
            for (const FaceSample& face : face_sampler_.meet(direction)) {
                push(face, rays);
            }
            continue;
        }
        if (const std::optional<double> distance = sampler_.meets(direction)) {
            push(direction, *distance, sampler_.solid_angle(), rays);
        }
    }
}

void LightTarget::push(const LightPointArrays& points, std::uint32_t count, DrawnRays& rays) const {
    for (std::uint32_t i = 0; i < count; ++i) {
        if (points.weight[i] > 0) {
            const Vec3f way(points.x[i], points.y[i], points.z[i]);
            // Each number is written once, see ShadowRaySpawner::to_end_of().
            DrawnRay& drawn = rays.drawn.extend(1)[0];
            drawn.way = way;
            drawn.light_density = 1 / points.weight[i];
            drawn.radiance = 1;
            drawn.hidden_layer = false;
            start_->to_end_of(way, rays.rays.extend(1)[0]);
        }
    }
}

void LightTarget::push(const Vec3d& direction, double distance, double weight, DrawnRays& rays) const {
    const auto factor = static_cast<float>(profile_->factor(direction));
    if (weight > 0 && factor > 0) {
        rays.push({Vec3f(frame_->to_world(direction)), static_cast<float>(1 / weight), factor, false},
                  start_->towards(direction, distance));
    }
}

void LightTarget::push(const FaceSample& sample, DrawnRays& rays) const {
    rays.push({Vec3f(frame_->to_world(sample.direction)), static_cast<float>(sample.density), 1, sample.hidden},
              start_->along(sample.direction));
    rays.color.push_back(glm::abs(sample.radiance));  // ShadowedLight sums up absolute values
}

Rgb LightTarget::strength() const {
    const auto* mesh = std::get_if<MeshLight>(light_);
    return mesh != nullptr && mesh->faces != nullptr ? Rgb(1) : glm::abs(strength_of(*light_));
}

void LightTarget::trace(ShadowTracer& tracer, DrawnRays& rays) {
    rays.visible.resize(rays.size());
    if (const auto* mesh = std::get_if<MeshLight>(light_)) {
        follow(*mesh, tracer, rays);
    } else {
        tracer.visibility(rays.rays.all(), rays.visible);
    }
}

/// Traces rays to a mesh light. What a ray sees of it are all its faces that are not opaque, each through those before
/// it, and the first opaque surface, which is the light or blocks it. A ray that misses a mesh with an approximate
/// outline is not blocked.
void LightTarget::follow(const MeshLight& mesh, ShadowTracer& tracer, DrawnRays& rays) {
    met_.resize(rays.size());
    tracer.intersect_opaque(rays.rays.all(), met_);
    for (std::size_t i = 0; i < met_.size(); ++i) {
        rays.rays[i].t_max = met_[i].missed() ? rays.rays[i].t_max : met_[i].distance;
    }
    passed_.assign(rays.size(), Rgb(1));
    sheer_.assign(rays.size(), Rgb(0));
    tracer.transmittance(rays.rays.all(), passed_, [&](std::size_t ray, const RayHit& hit) {
        sheer_[ray] += mesh.shines_at(hit, rays.rays[ray].direction) ? passed_[ray] : Rgb(0);
    });
    for (std::size_t i = 0; i < met_.size(); ++i) {
        const bool misses = met_[i].missed() && sheer_[i] == Rgb(0);
        const bool meets = !met_[i].missed() && mesh.shines_at(met_[i], rays.rays[i].direction);
        const Rgb seen = sheer_[i] + (misses || meets ? passed_[i] : Rgb(0));
        // What is seen through the layers before is part of what a ray to these sees.
        rays.visible[i] = rays.drawn[i].hidden_layer ? Rgb(0) : seen;
    }
}

void EnvironmentTarget::aim(const Hits& hits, std::size_t hit, std::size_t, bool) {
    const ShadingFrame& frame = hits.frame[hit];
    frame_ = &frame;
    const bool is_near = glm::distance(frame.origin, position_) < reach_ && glm::dot(frame.z, normal_) > kSameDensity;
    if (guide_ != nullptr && !is_near) {
        position_ = frame.origin;
        normal_ = frame.z;
        reach_ = kReach * guide_->spacing(position_);
        is_guided_ = guide_->find(frame, hits.shadow_origin[hit], density_);
    }
    start_.emplace(frame, hits.shadow_origin[hit], Vec3d(0));
    if (const EnvironmentMap* map = environment_->map()) {
        to_map_ = {map->to_map(frame.x), map->to_map(frame.y), map->to_map(frame.z)};
    }
}

void EnvironmentTarget::draw(const float* u, const float* v, std::uint32_t count, DrawnRays& rays) {
    const std::uint32_t kinds = environment_->map() != nullptr ? kShadowRay : kDiffuseRay | kGlossyRay;
    for (std::uint32_t i = 0; i < count; ++i) {
        if (is_guided_) {
            const SkyGuide::Sample sample = guide_->sample(density_, u[i], v[i]);
            push(frame_->to_local(sample.direction), sample.factor, kinds, rays);
        } else {
            push(environment_->map()->sampler.sample({u[i], v[i]}) * to_map_, 0, kinds, rays);
        }
    }
}

void EnvironmentTarget::meet(const RayVectors& directions, std::uint32_t count, RayKind kind, DrawnRays& rays) {
    for (std::uint32_t i = 0; i < count; ++i) {
        const Vec3d direction(directions.x[i], directions.y[i], directions.z[i]);
        push(direction, is_guided_ ? guide_->factor(density_, frame_->to_world(direction)) : 0.0F, kind, rays);
    }
}

void EnvironmentTarget::push(const Vec3d& direction, float factor, std::uint32_t kinds, DrawnRays& rays) const {
    if (direction.z > 0) {
        Ray ray = start_->along(direction);
        ray.kinds = kinds;
        rays.push({ray.direction, 0, 1, false}, ray);
        if (guide_ != nullptr) {
            rays.guided.push_back(factor);
        }
    }
}

void EnvironmentTarget::trace(ShadowTracer& tracer, DrawnRays& rays) {
    rays.visible.resize(rays.size());
    tracer.visibility(rays.rays.all(), rays.visible);
}

Rgb EnvironmentTarget::strength() const {
    return environment_->map() != nullptr ? Rgb(1) : environment_->radiance(Vec3d(0, 0, 1));
}

void EnvironmentTarget::find_radiance(std::span<const std::size_t> some, DrawnRays& rays) {
    if (environment_->map() == nullptr) {
        return;
    }
    const EnvironmentMap& map = *environment_->map();
    rays.color.resize(rays.size());
    rays.spot_color.resize(rays.size());
    std::array<std::array<float, kLookedUpAtOnce>, 10> lanes{};
    auto& [x, y, z, red, green, blue, spot_red, spot_green, spot_blue, density] = lanes;
    for (std::size_t first = 0; first < some.size(); first += kLookedUpAtOnce) {
        const std::size_t count = std::min(some.size() - first, kLookedUpAtOnce);
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3f direction(map.to_map(Vec3d(rays.drawn[some[first + i]].way)));
            x[i] = direction.x;
            y[i] = direction.y;
            z[i] = direction.z;
        }
        look_up(map, {x.data(), y.data(), z.data()}, count,
                {{red.data(), green.data(), blue.data()},
                 {spot_red.data(), spot_green.data(), spot_blue.data()},
                 density.data()});
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t ray = some[first + i];
            rays.drawn[ray].light_density = density[i];
            rays.color[ray] = {red[i], green[i], blue[i]};
            rays.spot_color[ray] = {spot_red[i], spot_green[i], spot_blue[i]};
        }
    }
}

void EnvironmentTarget::guide(std::span<const std::size_t> some, DrawnRays& rays) const {
    if (guide_ == nullptr) {
        return;
    }
    for (const std::size_t ray : some) {
        float& density = rays.drawn[ray].light_density;
        const float unguided = environment_->map() != nullptr ? density : 0.25F * std::numbers::inv_pi_v<float>;
        density = rays.guided[ray] > 0 ? rays.guided[ray] * unguided : density;
    }
}

}  // namespace shlight
