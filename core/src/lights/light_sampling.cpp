// SPDX-License-Identifier: MIT
#include "lights/light_sampling.h"

#include <variant>

namespace shlight {

void LightSampler::reset(const Light& light, const ShadingFrame& frame) {
    if (const auto* mesh = std::get_if<MeshLight>(&light)) {
        kind_ = Kind::mesh;
        mesh_.reset(*mesh, frame);
    } else if (const auto* polygon = std::get_if<PolygonLight>(&light)) {
        kind_ = Kind::polygon;
        polygon_.reset(*polygon, frame);
    } else if (const auto* disk = std::get_if<DiskLight>(&light)) {
        const LitDisk lit = lit_part(*disk, frame);
        kind_ = lit.corners.empty() ? Kind::ellipse : Kind::polygon;
        if (lit.corners.empty()) {
            ellipse_.emplace(lit.ellipse);
        } else {
            polygon_.reset(lit.corners, frame.to_local(disk->normal));
        }
    } else {
        kind_ = Kind::cap;
        cap_.emplace(*cap_view(light, frame));
    }
}

void LightSampler::move(const Light& light, const ShadingFrame& frame) {
    if (const auto* mesh = std::get_if<MeshLight>(&light)) {
        mesh_.move(*mesh, frame);
    } else {
        reset(light, frame);
    }
}

}  // namespace shlight
