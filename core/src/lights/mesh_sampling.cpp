// SPDX-License-Identifier: MIT
#include "lights/mesh_sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "emitters/emitter_levels.h"

namespace shlight {
namespace {

/// Tolerance of the outline, relative to the radiance reflected by a white surface. Rays hit the mesh itself, and the
/// outline only guides them.
constexpr double kTolerance = 2e-2;
/// Least share of the tolerance, used close to the mesh, where a level's error is comparable to the distance.
constexpr double kLeastShare = 5e-3;
/// Largest part of its size by which an outline is shrunk.
constexpr double kMostShrink = 0.1;
/// Largest distance between hits that share an outline ÷ their distance to the mesh.
constexpr double kNear = 0.05;

/// Angle of the direction in which plane points vary most about their middle.
double longest_direction(std::span<const glm::dvec2> points, const glm::dvec2& middle) {
    double xx = 0;
    double xy = 0;
    double yy = 0;
    for (const glm::dvec2& p : points) {
        const glm::dvec2 v = p - middle;
        xx += v.x * v.x;
        xy += v.x * v.y;
        yy += v.y * v.y;
    }
    return 0.5 * std::atan2(2 * xy, xx - yy);
}

glm::dvec2 middle_of(std::span<const glm::dvec2> points) {
    glm::dvec2 sum(0);
    for (const glm::dvec2& p : points) {
        sum += p;
    }
    return sum / static_cast<double>(points.size());
}

}  // namespace

void MeshSampler::reset(const MeshLight& light, const ShadingFrame& frame) {
    const EmitterLevels& shape = *light.shape;
    around_.reset();
    looked_from_ = frame.origin;
    const double distance = glm::length(shape.center - frame.origin);
    const double part = std::clamp(distance / shape.radius - 1, kLeastShare, 1.0);
    kind_ = view_.look(shape, frame, part * kTolerance * shown_share(shape, distance));
    if (kind_ == MeshView::Kind::outline) {
        // A coarse outline may be larger than the mesh, and rays to the difference would miss it.
        shrink_ = std::min(0.5 * view_.error() / shape.radius, kMostShrink);
        keep(frame);
        plane_ = view_.outline();
        enclose();
    } else {
        around_.emplace(CapView{CapView::Kind::inside, Vec3d(0, 0, 1), 1});
    }
}

void MeshSampler::move(const MeshLight& light, const ShadingFrame& frame) {
    const double distance = glm::length(light.shape->center - frame.origin) - light.shape->radius;
    const bool near = glm::length(frame.origin - looked_from_) <= kNear * distance;
    if (kind_ == MeshView::Kind::outline && near) {
        local_.clear();
        for (const Vec3d& v : edge_) {
            local_.push_back(frame.point_to_local(v));
        }
        const std::array<std::size_t, 1> ends = {local_.size()};
        if (plane_.draw(local_, ends)) {
            enclose();
            return;
        }
    }
    reset(light, frame);
}

/// Keeps the outline in world space, for hits near this one.
void MeshSampler::keep(const ShadingFrame& frame) {
    edge_.clear();
    for (const FlatOutline::Vertex& v : view_.outline().line(0)) {
        edge_.push_back(frame.origin + frame.to_world(v.depth * view_.outline().direction(v.at)));
    }
}

/// Shrinks the outline, and finds the enclosing rectangle along the outline's longest direction.
void MeshSampler::enclose() {
    outline_.clear();
    for (const FlatOutline::Vertex& v : plane_.line(0)) {
        outline_.push_back(v.at);
    }
    const glm::dvec2 middle = middle_of(outline_);
    for (glm::dvec2& p : outline_) {
        p = middle + (1 - shrink_) * (p - middle);
    }
    const double angle = longest_direction(outline_, middle);
    const glm::dvec2 u(std::cos(angle), std::sin(angle));
    const glm::dvec2 v(-u.y, u.x);
    glm::dvec2 low(std::numeric_limits<double>::infinity());
    glm::dvec2 high = -low;
    for (const glm::dvec2& p : outline_) {
        const glm::dvec2 q(glm::dot(p, u), glm::dot(p, v));
        low = glm::min(low, q);
        high = glm::max(high, q);
    }
    const auto corner = [&](double a, double b) { return plane_.direction(a * u + b * v); };
    rectangle_.reset({corner(low.x, low.y), corner(high.x, low.y), corner(high.x, high.y), corner(low.x, high.y)});
}

LightSample MeshSampler::sample(const glm::dvec2& point) const {
    LightSample drawn = around_ ? around_->sample(point) : rectangle_.sample(point);
    drawn.distance = std::numeric_limits<double>::infinity();
    if (!covers(drawn.direction)) {
        drawn.weight = 0;
    }
    return drawn;
}

std::optional<double> MeshSampler::meets(const Vec3d& direction) const {
    return covers(direction) ? std::optional(std::numeric_limits<double>::infinity()) : std::nullopt;
}

bool MeshSampler::covers(const Vec3d& direction) const {
    if (kind_ == MeshView::Kind::faces) {
        const std::span<const Vec3d> corners = view_.faces();
        for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
            const bool through = line_meets(direction, corners[i], corners[i + 1], corners[i + 2]);
            if (through && glm::dot(direction, corners[i] + corners[i + 1] + corners[i + 2]) > 0) {
                return true;
            }
        }
        return false;
    }
    if (kind_ != MeshView::Kind::outline) {
        return kind_ == MeshView::Kind::inside;
    }
    if (!(glm::dot(direction, plane_.axis()) > 0)) {
        return false;
    }
    // The winding number of the outline about the direction, counted over edges that cross the ray to its right. More
    // than one is an error of a coarse level.
    const glm::dvec2 p = plane_.shown(direction);
    int winding = 0;
    for (std::size_t i = 0; i < outline_.size(); ++i) {
        const glm::dvec2& a = outline_[i];
        const glm::dvec2& b = outline_[(i + 1) % outline_.size()];
        const double left = (b.x - a.x) * (p.y - a.y) - (p.x - a.x) * (b.y - a.y);
        winding += a.y <= p.y && b.y > p.y && left > 0 ? 1 : 0;
        winding -= a.y > p.y && b.y <= p.y && left < 0 ? 1 : 0;
    }
    return winding != 0;
}

}  // namespace shlight
