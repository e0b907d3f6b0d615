// SPDX-License-Identifier: MIT
//
// Pictures that show more than a plane can: a direction for each point of them, as Cycles' panoramic cameras have it.
// u goes from 0 at the picture's left edge to 1 at its right one, v likewise from bottom to top. The camera frame looks
// along -z, y is up, x to the right.
#pragma once

#include <array>
#include <numbers>
#include <optional>
#include <variant>

#include "shlight/types.h"

namespace shlight {

/// Longitude and latitude grow evenly, to the right and upwards; both are 0 ahead [rad].
struct Equirectangular {
    double longitude_min = -std::numbers::pi;
    double longitude_max = std::numbers::pi;
    double latitude_min = -std::numbers::pi / 2;
    double latitude_max = std::numbers::pi / 2;
};

/// A cylinder about y of radius 1, from height v_min to v_max; longitude u [rad] as of Equirectangular.
struct CentralCylindrical {
    double u_min = -std::numbers::pi;
    double u_max = std::numbers::pi;
    double v_min = -1;
    double v_max = 1;
};

/// The angle to the axis grows evenly with the distance from the picture's middle, to fov / 2 at its edges.
struct FisheyeEquidistant {
    double fov = std::numbers::pi;  ///< [rad]
};

/// What a fisheye's picture is caught on [m].
struct Sensor {
    double width = 0.036;
    double height = 0.036;
};

/// r = 2 lens sin(θ / 2) at a distance r from the sensor's middle, θ ≤ fov / 2 the angle to the axis.
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

/// What a ball ahead mirrors to a camera far away.
struct MirrorBall {};

/// The face of a cube; angles at its middle grow evenly.
struct EquiangularCubemapFace {};

using Panorama = std::variant<Equirectangular, CentralCylindrical, FisheyeEquidistant, FisheyeEquisolid,
                              FisheyeLensPolynomial, MirrorBall, EquiangularCubemapFace>;

/// Unit vector; none outside the lens's image.
std::optional<Vec3d> panorama_direction(const Panorama& panorama, double u, double v);

/// Unit vectors across a direction of panorama_direction, in which Cycles' aperture lies.
struct PanoramaAxes {
    Vec3d x, y;
};
PanoramaAxes panorama_axes(const Panorama& panorama, const Vec3d& direction);

/// Throws std::invalid_argument naming what is wrong: equirectangular_range, central_cylindrical_range, fisheye_fov,
/// fisheye_lens, fisheye_polynomial, sensor_width or sensor_height.
void check_panorama(const Panorama& panorama);

}  // namespace shlight
