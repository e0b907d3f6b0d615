// SPDX-License-Identifier: MIT
//
// Panoramic projections of Cycles: a direction for each point of a picture. u is 0 at the picture's left edge and 1 at
// its right edge; v likewise from bottom to top. The camera frame looks along -z, y is up, x to the right.
#pragma once

#include <array>
#include <numbers>
#include <optional>
#include <variant>

#include "shlight/types.h"

namespace shlight {

/// Longitude grows linearly to the right and latitude upwards; both are 0 ahead [rad].
struct Equirectangular {
    double longitude_min = -std::numbers::pi;
    double longitude_max = std::numbers::pi;
    double latitude_min = -std::numbers::pi / 2;
    double latitude_max = std::numbers::pi / 2;
};

/// A cylinder of radius 1 about y, from height v_min to v_max; u is the longitude [rad], as in Equirectangular.
struct CentralCylindrical {
    double u_min = -std::numbers::pi;
    double u_max = std::numbers::pi;
    double v_min = -1;
    double v_max = 1;
};

/// The angle to the axis is proportional to the distance from the picture's centre, and fov / 2 at its edges.
struct FisheyeEquidistant {
    double fov = std::numbers::pi;  ///< [rad]
};

/// Size of a fisheye camera's sensor [m].
struct Sensor {
    double width = 0.036;
    double height = 0.036;
};

/// r = 2 lens sin(θ / 2) at a distance r from the sensor's centre; θ ≤ fov / 2 is the angle to the axis.
struct FisheyeEquisolid {
    double lens = 0.0105;           ///< focal length [m]
    double fov = std::numbers::pi;  ///< [rad]
    Sensor sensor = {};
};

/// θ = -(k0 + k1 r + … + k4 r⁴).
struct FisheyeLensPolynomial {
    std::array<double, 5> coefficients = {};  ///< k0 … k4 [rad m^-i]
    double fov = std::numbers::pi;            ///< [rad]
    Sensor sensor = {};
};

/// The reflection in a mirror ball ahead, seen by a distant camera.
struct MirrorBall {};

/// One face of a cube map whose coordinates are proportional to angles.
struct EquiangularCubemapFace {};

using Panorama = std::variant<Equirectangular, CentralCylindrical, FisheyeEquidistant, FisheyeEquisolid,
                              FisheyeLensPolynomial, MirrorBall, EquiangularCubemapFace>;

/// Unit vector; none outside the lens's image.
std::optional<Vec3d> panorama_direction(const Panorama& panorama, double u, double v);

/// Unit vectors perpendicular to a direction of panorama_direction(), which span Cycles' aperture.
struct PanoramaAxes {
    Vec3d x, y;
};
PanoramaAxes panorama_axes(const Panorama& panorama, const Vec3d& direction);

/// Throws std::invalid_argument naming what is wrong: equirectangular_range, central_cylindrical_range, fisheye_fov,
/// fisheye_lens, fisheye_polynomial, sensor_width or sensor_height.
void check_panorama(const Panorama& panorama);

}  // namespace shlight
