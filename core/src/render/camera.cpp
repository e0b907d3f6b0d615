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

/// From where rays start: of an orthographic camera, all of the window.
void check_place(const glm::dmat4& to_world, const Window& window, Projection projection) {
    const double spread = projection == Projection::perspective ? 0 : 1;
    for (const double x : {window.left, window.right}) {
        for (const double y : {window.bottom, window.top}) {
            check_reach("to_world", largest_component(transform_point(to_world, spread * Vec3d(x, y, 0))));
        }
    }
}

}  // namespace

Camera::Camera(const glm::dmat4& to_world, double fov_x) : to_world_(to_world) {
    check_transform("to_world", to_world);
    check_place(to_world, {}, projection_);
    if (!(fov_x > 0 && fov_x < std::numbers::pi)) {
        reject("fov_x must lie between 0 and π");
    }
    half_width_ = std::tan(fov_x / 2);
}

Camera::Camera(const glm::dmat4& to_world, const Window& window, Projection projection, const ClipRange& clip)
    : to_world_(to_world), window_(window), projection_(projection), clip_(clip) {
    check_transform("to_world", to_world);
    check_window(window);
    check_place(to_world, window, projection);
    if (!(std::isfinite(clip.start) && clip.start >= 0)) {
        reject("clip_start must be finite and not negative");
    }
    if (!(clip.end > clip.start)) {
        reject("clip_end must be greater than clip_start");
    }
}

Window Camera::window(int width, int height) const {
    if (window_) {
        return *window_;
    }
    const double half_height = half_width_ * height / width;
    return {-half_width_, half_width_, -half_height, half_height};
}

Ray Camera::ray(double x, double y) const {
    const bool perspective = projection_ == Projection::perspective;
    // Per unit of depth, so that the clip range is measured along the view axis and not along the ray, as Blender does.
    const Vec3d per_depth = transform_vector(to_world_, perspective ? Vec3d(x, y, -1) : Vec3d(0, 0, -1));
    const double length = glm::length(per_depth);
    const Vec3d origin = transform_point(to_world_, perspective ? Vec3d(0) : Vec3d(x, y, 0));
    // What starts farther than anything may be sees nothing.
    const double start = std::min(clip_.start * length, 4 * kFarthest);
    return {Vec3f(origin), static_cast<float>(start), Vec3f(per_depth / length),
            static_cast<float>(clip_.end * length)};
}

double Camera::depth(const Vec3d& point) const {
    return -glm::dot(point - Vec3d(to_world_[3]), glm::normalize(Vec3d(to_world_[2])));
}

double Camera::distance(const Vec3d& point) const {
    return projection_ == Projection::perspective ? glm::length(point - Vec3d(to_world_[3])) : std::abs(depth(point));
}

Vec3d Camera::turned_to_frame(const Vec3d& direction) const {
    const auto along = [&](int axis) { return glm::dot(direction, glm::normalize(Vec3d(to_world_[axis]))); };
    return {along(0), along(1), along(2)};
}

}  // namespace shlight
