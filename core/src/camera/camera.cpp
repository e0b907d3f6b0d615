// SPDX-License-Identifier: MIT
#include "shlight/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/scene_range.h"
#include "base/transforms.h"

namespace shlight {
namespace {

void check_window(const Window& window) {
    const std::array edges = {std::pair("left", window.left), std::pair("right", window.right),
                              std::pair("bottom", window.bottom), std::pair("top", window.top)};
    for (const auto& [name, edge] : edges) {
        if (!std::isfinite(edge)) {
            reject(std::string(name) + " must be finite");
        }
    }
    if (!(window.left < window.right)) {
        reject("right must be greater than left");
    }
    if (!(window.bottom < window.top)) {
        reject("top must be greater than bottom");
    }
    for (const auto& [name, edge] : edges) {
        check_reach(name, edge);
    }
}

/// Checks the origins of rays, which for an orthographic camera lie in all of the window.
void check_place(const glm::dmat4& to_world, const Window& window, Projection projection) {
    const double spread = projection == Projection::perspective ? 0 : 1;
    for (const double x : {window.left, window.right}) {
        for (const double y : {window.bottom, window.top}) {
            check_reach("to_world", largest_component(transform_point(to_world, spread * Vec3d(x, y, 0))));
        }
    }
}

}  // namespace

Camera::Camera(const glm::dmat4& to_world, double fov_x, const Aperture& aperture)
    : to_world_(to_world), aperture_(aperture) {
    check();
    if (!(fov_x > 0 && fov_x < std::numbers::pi)) {
        reject("fov_x must lie between 0 and π");
    }
    half_width_ = std::tan(fov_x / 2);
}

Camera::Camera(const glm::dmat4& to_world, const Window& window, Projection projection, const ClipRange& clip,
               const Aperture& aperture)
    : to_world_(to_world), window_(window), projection_(projection), clip_(clip), aperture_(aperture) {
    check();
}

Camera::Camera(const glm::dmat4& to_world, const Panorama& panorama, const Window& window, const ClipRange& clip,
               const Aperture& aperture)
    : to_world_(to_world), window_(window), panorama_(panorama), clip_(clip), aperture_(aperture) {
    check_panorama(panorama);
    check();
}

void Camera::check() const {
    check_transform("to_world", to_world_);
    if (window_) {
        check_window(*window_);
    }
    check_place(to_world_, window_.value_or(Window{}), projection_);
    if (!(std::isfinite(clip_.start) && clip_.start >= 0)) {
        reject("clip_start must be finite and not negative");
    }
    if (!(clip_.end > clip_.start)) {
        reject("clip_end must be greater than clip_start");
    }
    check_aperture(aperture_);
    for (int axis = 0; axis < 3; ++axis) {
        check_reach("aperture_size", aperture_.reach() * largest_component(Vec3d(to_world_[axis])));
    }
}

Camera Camera::moved(const Vec3d& way) const {
    Camera result = *this;
    result.to_world_[3] += glm::dvec4(way, 0);
    return result;
}

Window Camera::window(int width, int height) const {
    if (window_) {
        return *window_;
    }
    const double half_height = half_width_ * height / width;
    return {-half_width_, half_width_, -half_height, half_height};
}

Ray Camera::ray(double x, double y, const std::optional<glm::dvec2>& square) const {
    const glm::dvec2 lens = square && has_depth_of_field() ? aperture_.point(*square) : glm::dvec2(0);
    // Slope from that point of the lens to the point in focus.
    const glm::dvec2 turn = lens / aperture_.focus_distance;
    if (panorama_) {
        const std::optional<Vec3d> ahead = panorama_direction(*panorama_, x, y);
        if (!ahead) {
            return {Vec3f(0), 0, Vec3f(0, 0, -1), -1};
        }
        if (!has_depth_of_field()) {
            return from_lens(Vec3d(0), *ahead);
        }
        const PanoramaAxes axes = panorama_axes(*panorama_, *ahead);
        return from_lens(axes.x * lens.x + axes.y * lens.y, glm::normalize(*ahead - axes.x * turn.x - axes.y * turn.y));
    }
    if (projection_ == Projection::perspective) {
        return from_lens(Vec3d(lens, 0), Vec3d(x - turn.x, y - turn.y, -1));
    }
    return from_lens(Vec3d(x + lens.x, y + lens.y, 0), Vec3d(glm::dvec2(0) - turn, -1));
}

Ray Camera::from_lens(const Vec3d& origin, const Vec3d& per_depth) const {
    // The clip range is measured along the view axis and not along the ray, as in Blender.
    const Vec3d direction = transform_vector(to_world_, per_depth);
    const double length = glm::length(direction);
    // Rays that start beyond all surfaces see nothing.
    const double start = std::min(clip_.start * length, 4 * kFarthest);
    return {Vec3f(transform_point(to_world_, origin)), static_cast<float>(start), Vec3f(direction / length),
            static_cast<float>(clip_.end * length)};
}

double Camera::depth(const Vec3d& point) const {
    return panorama_ ? distance(point) : -glm::dot(point - Vec3d(to_world_[3]), glm::normalize(Vec3d(to_world_[2])));
}

double Camera::distance(const Vec3d& point) const {
    return projection_ == Projection::perspective ? glm::length(point - Vec3d(to_world_[3])) : std::abs(depth(point));
}

Vec3d Camera::turned_to_frame(const Vec3d& direction) const {
    const auto along = [&](int axis) { return glm::dot(direction, glm::normalize(Vec3d(to_world_[axis]))); };
    return {along(0), along(1), along(2)};
}

}  // namespace shlight
