// SPDX-License-Identifier: MIT
#include "emitters/mesh_outlines.h"

#include "emitters/flat_outline.h"

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
    const std::size_t first = vertices_.size();
    switch (view_.look(emitter, frame, tolerance)) {
        case MeshView::Kind::hidden:
            break;
        case MeshView::Kind::outline:
            for (const FlatOutline::Vertex& v : view_.outline().line(0)) {
                vertices_.push_back(view_.outline().direction(v.at));
            }
            add(first, point);
            break;
        case MeshView::Kind::faces:
            for (std::size_t i = 0; i + 2 < view_.faces().size(); i += 3) {
                const std::span<const Vec3d> face = view_.faces().subspan(i, 3);
                vertices_.insert(vertices_.end(), face.begin(), face.end());
                add(first + i, point);
            }
            break;
        case MeshView::Kind::inside:
            inside_.push_back(point);
            break;
    }
}

void MeshOutlines::add(std::size_t first, std::uint32_t point) {
    const auto count = static_cast<std::uint32_t>(vertices_.size() - first);
    const std::uint32_t padded = count == 3 ? 3 : (count + kSizeStep - 1) / kSizeStep * kSizeStep;
    seen_.push_back({point, static_cast<std::uint32_t>(first), count, padded});
}

}  // namespace shlight
