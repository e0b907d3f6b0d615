// SPDX-License-Identifier: MIT
#include "mesh_outlines.h"

namespace shlight {
namespace {

/// More sizes make batches of fewer polygons each.
constexpr std::uint32_t kSizeStep = 8;

}  // namespace

void MeshOutlines::clear() {
    vertices_.clear();
    seen_.clear();
    inside_.clear();
}

void MeshOutlines::look(const EmitterLevels& emitter, const ShadingFrame& frame, double tolerance,
                        std::uint32_t point) {
    switch (view_.look(emitter, frame, tolerance)) {
        case MeshView::Kind::hidden:
            break;
        case MeshView::Kind::outline:
            add(view_.outline(), point);
            break;
        case MeshView::Kind::faces:
            for (std::size_t i = 0; i + 2 < view_.faces().size(); i += 3) {
                add(view_.faces().subspan(i, 3), point);
            }
            break;
        case MeshView::Kind::inside:
            inside_.push_back(point);
            break;
    }
}

void MeshOutlines::add(std::span<const Vec3d> polygon, std::uint32_t point) {
    const auto count = static_cast<std::uint32_t>(polygon.size());
    const std::uint32_t padded = count == 3 ? 3 : (count + kSizeStep - 1) / kSizeStep * kSizeStep;
    seen_.push_back({point, static_cast<std::uint32_t>(vertices_.size()), count, padded});
    vertices_.insert(vertices_.end(), polygon.begin(), polygon.end());
}

}  // namespace shlight
