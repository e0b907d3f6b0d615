// SPDX-License-Identifier: MIT
#include "emitters/silhouette.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace shlight {
namespace {

/// Mark of a missing step or place.
constexpr std::uint32_t kNoStep = std::numeric_limits<std::uint32_t>::max();
/// Height over a plane ÷ distance above which the side of the plane is certain.
constexpr double kSideMargin = 1e-9;

/// The side of all planes of a block on which a point lies.
enum class Side { front, back, both };

/// The side of all planes of a block. A normal at an angle of at most θ to the axis has an angle in φ ± θ to the
/// direction to the point, φ being that of the axis. Margins ensure that rounding never makes two blocks differ over a
/// face.
Side side_of(const EdgeBlock& block, const Vec3d& point) {
    const Vec3d way = point - block.center;
    const double square = glm::dot(way, way);
    const double up = glm::dot(way, block.axis);
    const double across = std::sqrt(std::max(0.0, square - up * up)) * block.sine;
    const double margin = kSideMargin * (std::abs(up) + across);
    if (up * block.cosine - across > std::max(block.high, 0.0) + margin) {
        return Side::front;
    }
    return up * block.cosine + across < std::min(block.low, 0.0) - margin ? Side::back : Side::both;
}

}  // namespace

bool Silhouette::find(const EmitterLevel& level, const Vec3d& point) {
    any_front_ = false;
    steps_.clear();
    origins_.clear();
    directions_.clear();
    ends_.clear();
    first_step_.resize(std::max(first_step_.size(), level.vertices.size()), kNoStep);
    place_.resize(first_step_.size(), kNoStep);
    for (const EdgeBlock& block : level.blocks) {
        switch (side_of(block, point)) {
            case Side::front:
                any_front_ = true;
                break;
            case Side::back:
                break;
            case Side::both:
                find_steps(level, block, point);
                break;
        }
    }
    for (const std::uint32_t origin : origins_) {
        walk(origin, level, point);
    }
    return !ends_.empty();
}

void Silhouette::find_steps(const EmitterLevel& level, const EdgeBlock& block, const Vec3d& point) {
    std::array<std::int8_t, 2 * kBlockEdges> sides;
    for (std::size_t i = 0; i < block.plane_count; ++i) {
        const EmitterPlane& plane = level.block_planes[block.first_plane + i];
        const double height = glm::dot(plane.normal, point) - plane.height;
        any_front_ |= height > 0;
        sides[i] = height > 0 ? 1 : 0;
    }
    for (std::size_t i = block.first; i < block.last; ++i) {
        const BlockEdge& edge = level.edges[i];
        const int times = sides[edge.left] - sides[edge.right];
        if (times > 0) {
            add(edge.from, edge.to);
        } else if (times < 0) {
            add(edge.to, edge.from);
        }
    }
}

void Silhouette::add(std::uint32_t from, std::uint32_t to) {
    steps_.push_back({to, first_step_[from]});
    first_step_[from] = static_cast<std::uint32_t>(steps_.size() - 1);
    origins_.push_back(from);
}

/// Walks along steps. Equally many enter and leave each vertex, so that every walk ends where it began.
void Silhouette::walk(std::uint32_t origin, const EmitterLevel& level, const Vec3d& point) {
    std::uint32_t vertex = origin;
    while (first_step_[vertex] != kNoStep) {
        place_[vertex] = static_cast<std::uint32_t>(path_.size());
        path_.push_back(vertex);
        const Step& step = steps_[first_step_[vertex]];
        first_step_[vertex] = step.next;
        vertex = step.to;
        if (place_[vertex] != kNoStep) {
            cut_off(place_[vertex], level, point);
        }
    }
}

/// Emits the end of the path, which has returned to an earlier vertex.
void Silhouette::cut_off(std::size_t first, const EmitterLevel& level, const Vec3d& point) {
    const auto line = std::span(path_).subspan(first);
    for (const std::uint32_t vertex : line) {
        place_[vertex] = kNoStep;
    }
    // Two vertices are an edge passed in both directions.
    if (line.size() > 2) {
        for (const std::uint32_t vertex : line) {
            directions_.push_back(level.vertices[vertex] - point);
        }
        ends_.push_back(directions_.size());
    }
    path_.resize(first);
}

}  // namespace shlight
