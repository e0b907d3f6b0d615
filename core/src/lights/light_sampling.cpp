// SPDX-License-Identifier: MIT
#include "lights/light_sampling.h"

#include <variant>

namespace shlight {
namespace {

/// Normal of a polygon or disk light.
const Vec3d& normal_of(const Light& light) {
    const auto* polygon = std::get_if<PolygonLight>(&light);
    return polygon != nullptr ? polygon->normal : std::get<DiskLight>(light).normal;
}

}  // namespace

void LightSampler::reset(const LocalLight& seen) {
    const ShadingFrame& frame = seen.frame();
    if (const auto* mesh = std::get_if<MeshLight>(&seen.light())) {
        kind_ = Kind::mesh;
        mesh_.reset(*mesh, frame);
    } else if (const auto* polygon = std::get_if<PolygonLight>(&seen.light()); polygon && !seen.is_part()) {
        kind_ = Kind::polygon;
        polygon_.reset(seen.corners(), polygon->triangles, frame.to_local(polygon->normal));
    } else if (seen.is_part()) {
        kind_ = Kind::polygon;
        polygon_.reset(seen.corners(), frame.to_local(normal_of(seen.light())));
    } else if (seen.cap()) {
        kind_ = Kind::cap;
        cap_.emplace(*seen.cap());
    } else {
        kind_ = Kind::ellipse;
        ellipse_.emplace(seen.ellipse());
    }
}

void LightSampler::move(const LocalLight& seen) {
    if (const auto* mesh = std::get_if<MeshLight>(&seen.light())) {
        mesh_.move(*mesh, seen.frame());
    } else {
        reset(seen);
    }
}

}  // namespace shlight
