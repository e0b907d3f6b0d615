// SPDX-License-Identifier: MIT
#include "emitters/mesh_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/ray_rounding.h"

namespace shlight {

MeshView::Kind MeshView::look(const EmitterLevels& emitter, const ShadingFrame& frame, double tolerance) {
    const Vec3d to_center = emitter.center - frame.origin;
    const double distance = glm::length(to_center);
    if (frame.to_local(to_center).z <= -emitter.radius) {
        return Kind::hidden;
    }
    const EmitterLevel& level = level_for(emitter, distance, tolerance);
    error_ = level.error;
    Vec3d point = frame.origin;
    bool outlined = silhouette_.find(level, point);
    if (distance < emitter.radius + error_ && !silhouette_.any_front()) {
        // A coarse level may be in front of the surface that was hit, and rounding on either side of it.
        point += (2 * error_ + kMeshRounding * emitter.radius) * frame.z;
        outlined = silhouette_.find(level, point);
        if (!silhouette_.any_front()) {
            return emitter.one_sided ? Kind::hidden : Kind::inside;
        }
    }
    if (!outlined) {
        return Kind::hidden;
    }
    local_.clear();
    for (const Vec3d& direction : silhouette_.directions()) {
        local_.push_back(frame.to_local(direction));
    }
    // A convex surface is below the horizon of a hit on it, but a coarse level may rise above it.
    const double above = distance < emitter.radius + error_ ? 2 * error_ : 0;
    const bool rises = std::any_of(local_.begin(), local_.end(), [&](const Vec3d& v) { return v.z > above; });
    // Seen from outside, a convex surface covers less than half of space, and so is never all above the horizon.
    if (!rises) {
        return Kind::hidden;
    }
    if (outline_.draw(local_, silhouette_.ends()) && outline_.area() > 0) {
        outline_.thin_out(tolerance * std::numbers::pi / kOneSided, kOneSided);
        outline_.join();
        return Kind::outline;
    }
    return look_at_faces(level, point, frame);
}

/// Only faces that show their outer side: the others are hidden behind these.
MeshView::Kind MeshView::look_at_faces(const EmitterLevel& level, const Vec3d& point, const ShadingFrame& frame) {
    faces_.clear();
    for (std::size_t i = 0; i < level.faces.size(); ++i) {
        const double height = glm::dot(level.planes[i].normal, point) - level.planes[i].height;
        if (!(height > 0)) {
            continue;
        }
        std::array<Vec3d, 3> corners;
        for (int corner = 0; corner < 3; ++corner) {
            corners[corner] = frame.to_local(level.vertices[level.faces[i][corner]] - point);
        }
        if (std::any_of(corners.begin(), corners.end(), [](const Vec3d& v) { return v.z > 0; })) {
            faces_.insert(faces_.end(), corners.begin(), corners.end());
        }
    }
    return faces_.empty() ? Kind::hidden : Kind::faces;
}

}  // namespace shlight
