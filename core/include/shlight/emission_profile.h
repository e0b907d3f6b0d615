// SPDX-License-Identifier: MIT
//
// Emission profiles: how the radiance of a light depends on the direction of emission.
//
// The light's radiance is multiplied by a factor of the world direction from the light to the lit point. Where
// profile_range() shows that the factor is constant over the light as seen from a point, it is only a scale.
#pragma once

#include <memory>
#include <variant>

#include <glm/mat3x3.hpp>

#include "shlight/direction_table.h"
#include "shlight/types.h"

namespace shlight {

/// Factor 1 in all directions.
struct EvenProfile {
    bool operator==(const EvenProfile&) const = default;
};

/// A cone with a soft rim: with z the cosine of the angle to the cone's axis, smoothstep((z - c) / ((1 - c) blend)),
/// and 0 for z ≤ c. A spot lamp of Blender (Cycles, spot_light_attenuation).
struct SpotProfile {
    glm::dmat3 to_local;  ///< from the world to a frame in which the cone is round about z; of any scale
    double stretch;       ///< largest ratio of an angle in that frame to the world's
    double cosine;        ///< c, cosine of half the cone's angle, 0 ≤ c < 1
    double blend;         ///< 0 … 1: the share of 1 - c over which the rim fades
    bool times_cosine;    ///< multiplies by z, as spot lamps before Blender 4

    bool operator==(const SpotProfile&) const = default;
};

/// A panel behind a honeycomb grid: max(tan h - tan α, 0) / (tan h - h), with α the angle to the panel's normal and h
/// half the spread. Its power is that of an even panel. An area lamp of Blender with a spread below 180°.
struct SpreadProfile {
    Vec3d normal;       ///< unit
    double half_angle;  ///< h, 0 < h < π/2
    double tangent;     ///< tan h
    double scale;       ///< 1 / (tan h - h)

    bool operator==(const SpreadProfile&) const = default;
};

/// A sun of constant radiance on the plane tangent to the sphere of directions at the sun's centre: 1 / cos³α, with α
/// the angle to its axis. Sun lamps before Blender 4.
struct TangentProfile {
    Vec3d axis;  ///< unit, direction in which the light travels

    bool operator==(const TangentProfile&) const = default;
};

/// A factor that is a formula.
using PlainProfile = std::variant<EvenProfile, SpotProfile, SpreadProfile, TangentProfile>;

/// A plain factor times that of a table, for instance of a luminaire that was measured.
struct TableProfile {
    std::shared_ptr<const DirectionTable> table;  ///< not null
    glm::dmat3 to_table;                          ///< from the world to the table's frame
    PlainProfile plain;

    bool operator==(const TableProfile&) const = default;
};

using EmissionProfile = std::variant<EvenProfile, SpotProfile, SpreadProfile, TangentProfile, TableProfile>;

/// Axes for make_spot_profile() of a lamp that shines along a direction of any length > 0.
/// Throws std::invalid_argument naming the argument: a number that is not finite, length 0.
glm::dmat3 lamp_axes(const Vec3d& direction);

/// axes: columns x, y, z, of any length, of the lamp's frame, in which it shines along -z.
/// spot_angle: full angle of the cone [rad]. Throws std::invalid_argument naming the argument: a number that is not
/// finite, axes without volume, a spot_angle outside (0, π], a blend outside 0 … 1.
SpotProfile make_spot_profile(const glm::dmat3& axes, double spot_angle, double blend, bool times_cosine = false);

/// spread: twice h [rad]; π, within rounding, gives an even profile. normal: any length > 0.
/// Throws std::invalid_argument naming the argument: a spread outside (0, π].
EmissionProfile make_spread_profile(const Vec3d& normal, double spread);

/// The plain part of a profile times a table.
TableProfile with_table(const EmissionProfile& profile, std::shared_ptr<const DirectionTable> table,
                        const glm::dmat3& to_table);

/// direction: unit, in the world, from the light to the lit point.
double profile_factor(const EmissionProfile& profile, const Vec3d& direction);

/// Bounds of the factor over the cap of directions within half_angle [0, π] of a unit direction.
ProfileRange profile_range(const EmissionProfile& profile, const Vec3d& direction, double half_angle);

/// An angle [rad] over which the factor changes little around a unit direction: the width of the rim or of the spread,
/// plus the direction's distance from it; at most 1.
double profile_scale(const EmissionProfile& profile, const Vec3d& direction);

}  // namespace shlight
