// SPDX-License-Identifier: MIT
#include "surfaces/lamp_drawer.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <variant>

#include <glm/geometric.hpp>

namespace shlight {
namespace {

using std::numbers::pi;

double size_of(const SunLight& lamp, const Vec3d& /*from*/) {
    return pi * lamp.half_angle * lamp.half_angle;
}

template <class Lamp>
double size_of(const Lamp& lamp, const Vec3d& from) {
    const Vec3d way = lamp.center - from;
    return pi * lamp.radius * lamp.radius / glm::dot(way, way);
}

double size_of(const MeshLight& /*lamp*/, const Vec3d& /*from*/) {
    return std::numeric_limits<double>::infinity();
}

double size_of(const PointSource& /*lamp*/, const Vec3d& /*from*/) {
    return 0;
}

double size_of(const ParallelSource& /*lamp*/, const Vec3d& /*from*/) {
    return 0;
}

/// The direction to a lamp without extent, in the world, and what it sends along it.
LampDraw drawn(const PointSource& lamp, const Vec3d& from) {
    const Vec3d way = lamp.position - from;
    const double distance = glm::length(way);
    return {way / distance, distance, lamp.intensity / static_cast<float>(distance * distance)};
}

LampDraw drawn(const ParallelSource& lamp, const Vec3d& /*from*/) {
    return {lamp.direction, std::numeric_limits<double>::infinity(), lamp.irradiance};
}

template <class Lamp>
std::optional<LampDraw> drawn_without_extent(const Lamp& lamp, const ShadingFrame& frame, double error) {
    LampDraw draw = drawn(lamp, frame.origin);
    draw.light *= static_cast<float>(profile_factor(lamp.traits.profile, -draw.direction));
    draw.direction = frame.to_local(draw.direction);
    return draw.distance > 2 * error && draw.direction.z > 0 ? std::optional(draw) : std::nullopt;
}

}  // namespace

double apparent_size(const Light& lamp, const Vec3d& from) {
    return std::visit([&](const auto& own) { return size_of(own, from); }, lamp);
}

std::optional<LampDraw> LampDrawer::draw(const Light& lamp, const ShadingFrame& frame, double error,
                                         const glm::dvec2& point) {
    if (const auto* own = std::get_if<PointSource>(&lamp)) {
        return drawn_without_extent(*own, frame, error);
    }
    if (const auto* own = std::get_if<ParallelSource>(&lamp)) {
        return drawn_without_extent(*own, frame, error);
    }
    if (!local_.look(lamp, frame, error)) {
        return std::nullopt;
    }
    sampler_.reset(local_);
    const LightSample sample = sampler_.sample(point);
    const double factor = sample.weight * local_.profile().factor(sample.direction);
    return LampDraw{sample.direction, sample.distance, static_cast<float>(factor) * strength_of(lamp)};
}

}  // namespace shlight
