// SPDX-License-Identifier: MIT
//
// Light that shines unevenly: its radiance as a function of the direction in which it leaves, and of nothing else.
//
// The light's own radiance is multiplied by a factor of the world direction from the light to the lit point. Where the
// factor is the same over the whole light, as seen from a point, that is all; profile_range tells.
#pragma once

#include <variant>

#include <glm/mat3x3.hpp>

#include "shlight/types.h"

namespace shlight {

/// The same in all directions: factor 1.
struct EvenProfile {};

/// A cone with a soft rim: with z the cosine of the angle to the cone's axis, smoothstep((z - c) / ((1 - c) blend)),
/// and 0 for z ≤ c. A spot lamp of Blender (Cycles, spot_light_attenuation).
struct SpotProfile {
    glm::dmat3 to_local;  ///< from the world to a frame in which the cone is round about z; of any scale
    double stretch;       ///< at most so much larger are angles in that frame
    double cosine;        ///< c, of half the cone's angle, 0 ≤ c < 1
    double blend;         ///< 0 … 1: the share of 1 - c over which the rim fades
    bool times_cosine;    ///< once more times z: spot lamps before Blender 4
};

/// A panel behind a honeycomb grid: max(tan h - tan α, 0) / (tan h - h), with α the angle to the panel's normal and h
/// half the spread. It sends out as much light as an even panel. An area lamp of Blender with a spread below 180°.
struct SpreadProfile {
    Vec3d normal;       ///< unit
    double half_angle;  ///< h, 0 < h < π/2
    double tangent;     ///< of h
    double scale;       ///< 1 / (tan h - h)
};

/// A sun that sends out evenly what meets the plane tangent to the sphere of directions at its middle: 1 / cos³α, with
/// α the angle to its axis. Sun lamps before Blender 4.
struct TangentProfile {
    Vec3d axis;  ///< unit, the way the light travels
};

using EmissionProfile = std::variant<EvenProfile, SpotProfile, SpreadProfile, TangentProfile>;

/// Axes for make_spot_profile of a lamp that shines this way, of any length > 0.
/// Throws std::invalid_argument naming the argument: a number that is not finite, length 0.
glm::dmat3 lamp_axes(const Vec3d& direction);

/// axes: columns x, y, z of the lamp's frame, which shines along -z, of any scale; directions are seen in that frame.
/// spot_angle: of the whole cone [rad]. Throws std::invalid_argument naming the argument: a number that is not finite,
/// axes without volume, a spot_angle outside (0, π], a blend outside 0 … 1.
SpotProfile make_spot_profile(const glm::dmat3& axes, double spot_angle, double blend, bool times_cosine = false);

/// spread: twice h [rad]; π, or less by rounding, is even. normal: any length > 0.
/// Throws std::invalid_argument naming the argument: a spread outside (0, π].
EmissionProfile make_spread_profile(const Vec3d& normal, double spread);

/// direction: unit, in the world, from the light to the lit point.
double profile_factor(const EmissionProfile& profile, const Vec3d& direction);

struct ProfileRange {
    double low, high;
};

/// Bounds of the factor over the cap of directions within half_angle [0, π] of a unit direction.
ProfileRange profile_range(const EmissionProfile& profile, const Vec3d& direction, double half_angle);

/// An angle [rad] over which the factor changes little around a unit direction: at least the width of the rim or of the
/// spread, more by as much as the direction lies off it; at most 1.
double profile_scale(const EmissionProfile& profile, const Vec3d& direction);

}  // namespace shlight
