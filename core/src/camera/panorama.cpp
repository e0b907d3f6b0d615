// SPDX-License-Identifier: MIT
#include "shlight/panorama.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/checks.h"
#include "base/perpendicular.h"
#include "base/scene_range.h"

namespace shlight {
namespace {

constexpr Vec3d kOutside(0);

/// The direction at an angle to the axis, at the azimuth of a point of the picture.
Vec3d fisheye(double angle, const glm::dvec2& from_middle) {
    const double radius = glm::length(from_middle);
    const glm::dvec2 side = radius > 0 ? from_middle / radius : glm::dvec2(0, 1);
    return {std::sin(angle) * side.x, std::sin(angle) * side.y, -std::cos(angle)};
}

glm::dvec2 on_sensor(const glm::dvec2& uv, const Sensor& sensor) {
    return (uv - 0.5) * glm::dvec2(sensor.width, sensor.height);
}

Vec3d direction_of(const Equirectangular& panorama, const glm::dvec2& uv) {
    const double longitude = glm::mix(panorama.longitude_min, panorama.longitude_max, uv.x);
    const double latitude = glm::mix(panorama.latitude_min, panorama.latitude_max, uv.y);
    return {std::cos(latitude) * std::sin(longitude), std::sin(latitude), -std::cos(latitude) * std::cos(longitude)};
}

Vec3d direction_of(const CentralCylindrical& panorama, const glm::dvec2& uv) {
    const double longitude = glm::mix(panorama.u_min, panorama.u_max, uv.x);
    return {std::sin(longitude), glm::mix(panorama.v_min, panorama.v_max, uv.y), -std::cos(longitude)};
}

Vec3d direction_of(const FisheyeEquidistant& panorama, const glm::dvec2& uv) {
    const glm::dvec2 from_middle = 2.0 * uv - 1.0;
    const double radius = glm::length(from_middle);
    return radius > 1 ? kOutside : fisheye(radius * panorama.fov / 2, from_middle);
}

Vec3d direction_of(const FisheyeEquisolid& panorama, const glm::dvec2& uv) {
    const glm::dvec2 from_middle = on_sensor(uv, panorama.sensor);
    const double sine = glm::length(from_middle) / (2 * panorama.lens);
    return sine > std::sin(panorama.fov / 4) ? kOutside : fisheye(2 * std::asin(std::min(sine, 1.0)), from_middle);
}

Vec3d direction_of(const FisheyeLensPolynomial& panorama, const glm::dvec2& uv) {
    const glm::dvec2 from_middle = on_sensor(uv, panorama.sensor);
    double angle = 0;
    for (std::size_t i = panorama.coefficients.size(); i-- > 0;) {
        angle = angle * glm::length(from_middle) - panorama.coefficients[i];
    }
    return std::abs(angle) > panorama.fov / 2 ? kOutside : fisheye(angle, from_middle);
}

Vec3d direction_of(const MirrorBall&, const glm::dvec2& uv) {
    const glm::dvec2 on_ball = 2.0 * uv - 1.0;
    const double across = glm::dot(on_ball, on_ball);
    const double towards = std::sqrt(std::max(1 - across, 0.0));
    return across > 1 ? kOutside : Vec3d(2 * towards * on_ball, 1 - 2 * towards * towards);
}

Vec3d direction_of(const EquiangularCubemapFace&, const glm::dvec2& uv) {
    return {std::tan((uv.x - 0.5) * std::numbers::pi / 2), std::tan((uv.y - 0.5) * std::numbers::pi / 2), -1};
}

void check_ranges(const std::string& name, const std::array<double, 4>& ends) {
    for (const double end : ends) {
        check_reach(name, end);
    }
    if (ends[0] == ends[1] || ends[2] == ends[3]) {
        reject(name + " must not be empty");
    }
}

void check_fov(double fov) {
    if (!(fov > 0 && fov <= 10 * std::numbers::pi)) {
        reject("fisheye_fov must be positive and at most 10 π");
    }
}

void check_length(const char* name, double length) {
    if (!(length > 0 && length <= kFarthest)) {
        reject(std::string(name) + " must be positive and at most 1e10");
    }
}

void check_sensor(const Sensor& sensor) {
    check_length("sensor_width", sensor.width);
    check_length("sensor_height", sensor.height);
}

void check_kind(const Equirectangular& panorama) {
    check_ranges("equirectangular_range",
                 {panorama.longitude_min, panorama.longitude_max, panorama.latitude_min, panorama.latitude_max});
}

void check_kind(const CentralCylindrical& panorama) {
    check_ranges("central_cylindrical_range", {panorama.u_min, panorama.u_max, panorama.v_min, panorama.v_max});
}

void check_kind(const FisheyeEquidistant& panorama) {
    check_fov(panorama.fov);
}

void check_kind(const FisheyeEquisolid& panorama) {
    check_length("fisheye_lens", panorama.lens);
    check_fov(panorama.fov);
    check_sensor(panorama.sensor);
}

void check_kind(const FisheyeLensPolynomial& panorama) {
    for (const double coefficient : panorama.coefficients) {
        if (!std::isfinite(coefficient)) {
            reject("fisheye_polynomial must be finite");
        }
    }
    check_fov(panorama.fov);
    check_sensor(panorama.sensor);
}

void check_kind(const MirrorBall&) {}

void check_kind(const EquiangularCubemapFace&) {}

}  // namespace

std::optional<Vec3d> panorama_direction(const Panorama& panorama, double u, double v) {
    const Vec3d found = std::visit([&](const auto& kind) { return direction_of(kind, glm::dvec2(u, v)); }, panorama);
    // A polynomial may overflow.
    const double length = glm::length(found);
    return length > 0 && std::isfinite(length) ? std::optional(found / length) : std::nullopt;
}

PanoramaAxes panorama_axes(const Panorama& panorama, const Vec3d& direction) {
    // Cycles' frame of a mirror ball has the x axis of the camera frame, but is left-handed; that of other panoramas
    // has the view axis as its x axis.
    const bool ball = std::holds_alternative<MirrorBall>(panorama);
    const Vec3d along = ball ? Vec3d(1, 0, 0) : Vec3d(0, 0, -1);
    const Vec3d across = along - glm::dot(along, direction) * direction;
    const double length = glm::length(across);
    const Vec3d x = length > 0 ? across / length : perpendicular(direction);
    return {x, ball ? glm::cross(x, direction) : glm::cross(direction, x)};
}

void check_panorama(const Panorama& panorama) {
    std::visit([](const auto& kind) { check_kind(kind); }, panorama);
}

}  // namespace shlight
