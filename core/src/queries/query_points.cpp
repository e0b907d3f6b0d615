// SPDX-License-Identifier: MIT
#include "queries/query_points.h"

#include <algorithm>
#include <array>

#include "base/ray_rounding.h"
#include "base/unit_direction.h"
#include "surfaces/placed_meshes.h"

namespace shlight {

Ray query_ray(const CompiledScene& scene, const Vec3d& origin, const Vec3d& direction) {
    return {Vec3f(origin - scene.origin()), 0, Vec3f(unit_direction(direction)), Ray().t_max, kAllRays};
}

void QueryPoints::set(std::span<const Vec3d> points, std::span<const ShadingFrame> frames) {
    hits_.clear();
    rays_.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
        rays_.push_back(query_ray(*scene_, points[i], frames[i].z));
        rays_.push_back(query_ray(*scene_, points[i], -frames[i].z));
    }
    met_.resize(rays_.size());
    scene_->rays().intersect(rays_, met_);
    constexpr std::array kWhite = {Rgb(1)};
    constexpr std::array kForm = {LobeForm()};
    for (std::size_t i = 0; i < points.size(); ++i) {
        ShadingFrame frame = frames[i];
        frame.origin = points[i] - scene_->origin();
        hits_.add({frame.origin, frame.z, frame.z, error(frame.origin, 2 * i), 0}, Terminator(), frame, 1, kWhite,
                  kForm, 0, PathKind::direct, 0);
        hits_.end_pixel();
    }
}

double QueryPoints::error(const Vec3d& point, std::size_t first) const {
    double error = kRayRounding * largest_component(point);
    for (std::size_t ray = first; ray < first + 2; ++ray) {
        if (!met_[ray].missed()) {
            const SurfacePoint surface = scene_->placed().surface(met_[ray], rays_[ray].direction);
            error = glm::distance(surface.position, point) <= surface.error ? std::max(error, surface.error) : error;
        }
    }
    return error;
}

}  // namespace shlight
