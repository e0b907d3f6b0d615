// SPDX-License-Identifier: MIT
#pragma once

#include <limits>
#include <optional>
#include <variant>

#include "base/shading_frame.h"
#include "shlight/emission_profile.h"
#include "shlight/light.h"
#include "shlight/types.h"

namespace shlight {

/// A source without extent, seen from a point.
struct DeltaView {
    Vec3d direction;    ///< unit, in the shading frame
    double distance;    ///< may be infinite
    double irradiance;  ///< on a perpendicular surface, from a source of strength 1
};

/// Nothing for a source below the horizon, one whose profile is 0 in this direction, or one within twice `error` of the
/// hit. Precondition: is_delta(light).
inline std::optional<DeltaView> delta_view(const Light& light, const ShadingFrame& frame, double error) {
    DeltaView seen{};
    if (const auto* parallel = std::get_if<ParallelSource>(&light)) {
        seen = {frame.to_local(parallel->direction), std::numeric_limits<double>::infinity(), 1.0};
    } else {
        const Vec3d way = std::get<PointSource>(light).position - frame.origin;
        seen.distance = glm::length(way);
        if (!(seen.distance > 2 * error)) {
            return std::nullopt;
        }
        seen.direction = frame.to_local(way / seen.distance);
        seen.irradiance = 1 / (seen.distance * seen.distance);
    }
    if (!(seen.direction.z > 0)) {
        return std::nullopt;
    }
    // Most sources have no profile, and the world direction is computed for the others only.
    const EmissionProfile& profile = traits_of(light).profile;
    if (!std::holds_alternative<EvenProfile>(profile)) {
        seen.irradiance *= profile_factor(profile, -frame.to_world(seen.direction));
    }
    return seen.irradiance > 0 ? std::optional(seen) : std::nullopt;
}

}  // namespace shlight
