// SPDX-License-Identifier: MIT
#include "emitters/mesh_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace shlight {
namespace {

/// Error of a hit on the mesh ÷ the mesh's extent.
constexpr double kRounding = 1e-5;

/// Whether a projected edge passes to the right of the origin, and its direction: 1 up, -1 down. An end at the origin's
/// height counts as above, so that lines of edges are met once.
int passes_right(const Vec3d& a, const Vec3d& b) {
    if ((a.y >= 0) == (b.y >= 0)) {
        return 0;
    }
    const double left = (b.x - a.x) * -a.y + a.x * (b.y - a.y);
    return b.y >= 0 ? (left > 0 ? 1 : 0) : (left < 0 ? -1 : 0);
}

/// Whether a closed surface winds around the point, by its crossings with the ray upwards from there.
bool encloses(const EmitterLevel& level, const Vec3d& point) {
    int winding = 0;
    for (std::size_t i = 0; i < level.faces.size(); ++i) {
        const Triangle& f = level.faces[i];
        const Vec3d a = level.vertices[f.x] - point;
        const Vec3d b = level.vertices[f.y] - point;
        const Vec3d c = level.vertices[f.z] - point;
        const int around = passes_right(a, b) + passes_right(b, c) + passes_right(c, a);
        const EmitterPlane& plane = level.planes[i];
        const double behind = plane.height - glm::dot(plane.normal, point);
        winding += (plane.normal.z > 0) == (behind > 0) ? around : 0;
    }
    return winding != 0;
}

}  // namespace

MeshView::Kind MeshView::look(const EmitterLevels& emitter, const ShadingFrame& frame, double tolerance) {
    const Vec3d to_center = emitter.center - frame.origin;
    const double distance = glm::length(to_center);
    if (frame.to_local(to_center).z <= -emitter.radius) {
        return Kind::hidden;
    }
    const EmitterLevel& level = level_for(emitter, distance, tolerance);
    error_ = level.error;
    Vec3d point = frame.origin;
    bool outlined = silhouette_.find(level, emitter.only_outer(), point);
    const auto is_inside = [&] { return emitter.convex ? !silhouette_.any_front() : encloses(level, point); };
    if (emitter.closed && distance < emitter.radius + error_ && is_inside()) {
        // A coarse level may be in front of the surface that was hit, and rounding on either side of it.
        point += (2 * error_ + kRounding * emitter.radius) * frame.z;
        outlined = silhouette_.find(level, true, point);
        if (is_inside() && !emitter.one_sided) {
            return outlined ? look_at_faces(level, point, frame, false) : Kind::inside;
        }
    }
    if (!outlined) {
        const bool surrounds = emitter.one_sided && silhouette_.any_front();
        return surrounds ? Kind::inside : Kind::hidden;
    }
    local_.clear();
    for (const Vec3d& direction : silhouette_.directions()) {
        local_.push_back(frame.to_local(direction));
    }
    // A convex surface is below the horizon of a hit on it, but a coarse level may rise above it.
    const double above = emitter.convex && distance < emitter.radius + error_ ? 2 * error_ : 0;
    const bool rises = std::any_of(local_.begin(), local_.end(), [&](const Vec3d& v) { return v.z > above; });
    // Seen from outside, a convex surface covers less than half of space, and so is never all above the horizon.
    if (emitter.convex && !rises) {
        return Kind::hidden;
    }
    // A reversed outline stands for all directions but those inside: in a bowl the surface is everywhere but in its
    // opening.
    if (outline_.draw(local_, silhouette_.ends()) && outline_.area() > 0) {
        if (!rises) {
            return Kind::hidden;
        }
        outline_.thin_out(tolerance * std::numbers::pi / kOneSided, kOneSided);
        outline_.join();
        return Kind::outline;
    }
    return look_at_faces(level, point, frame, emitter.only_outer());
}

/// front_only: only faces that show their outer side; the others are hidden behind these.
MeshView::Kind MeshView::look_at_faces(const EmitterLevel& level, const Vec3d& point, const ShadingFrame& frame,
                                       bool front_only) {
    faces_.clear();
    for (std::size_t i = 0; i < level.faces.size(); ++i) {
        const double height = glm::dot(level.planes[i].normal, point) - level.planes[i].height;
        if (height == 0 || (front_only && height < 0)) {
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
