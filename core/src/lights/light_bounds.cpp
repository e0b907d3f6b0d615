// SPDX-License-Identifier: MIT
#include "lights/light_bounds.h"

#include <cmath>
#include <variant>

namespace shlight {
namespace {

struct BoxAbout {
    std::optional<LightBounds> operator()(const SphereLight& sphere) const {
        return LightBounds{Box::around(sphere.center, Vec3d(sphere.radius)), false};
    }
    std::optional<LightBounds> operator()(const PolygonLight& polygon) const {
        LightBounds bounds = {Box(), false};
        for (const Vec3d& vertex : polygon.vertices) {
            bounds.box.include(vertex);
        }
        return bounds;
    }
    std::optional<LightBounds> operator()(const DiskLight& disk) const {
        return LightBounds{Box::around(disk.center, glm::abs(disk.half_axis_u) + glm::abs(disk.half_axis_v)), false};
    }
    std::optional<LightBounds> operator()(const SunLight& sun) const {
        return LightBounds{Box::around(sun.direction, Vec3d(2 * std::sin(sun.half_angle / 2))), true};
    }
    std::optional<LightBounds> operator()(const PointSource& point) const {
        return LightBounds{{point.position, point.position}, false};
    }
    std::optional<LightBounds> operator()(const ParallelSource& parallel) const {
        return LightBounds{{parallel.direction, parallel.direction}, true};
    }
    std::optional<LightBounds> operator()(const MeshLight& /*mesh*/) const { return std::nullopt; }
};

}  // namespace

std::optional<LightBounds> bounds_of(const Light& light) {
    return std::visit(BoxAbout(), light);
}

}  // namespace shlight
