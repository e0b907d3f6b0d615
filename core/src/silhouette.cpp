// SPDX-License-Identifier: MIT
#include "silhouette.h"

#include <algorithm>

namespace shlight {
namespace {

constexpr std::uint32_t kNoStep = EmitterEdge::kNone;
/// Cosine to the axis of the half space that a flattened outline keeps at least.
constexpr double kLeastCosine = 0.02;

}  // namespace

bool Silhouette::find(const EmitterLevel& level, bool closed, const Vec3d& point) {
    side_.resize(level.planes.size());
    any_front_ = false;
    for (std::size_t i = 0; i < level.planes.size(); ++i) {
        const double height = glm::dot(level.planes[i].normal, point) - level.planes[i].height;
        const int back = closed ? 0 : int{height < 0};
        side_[i] = static_cast<std::int8_t>(int{height > 0} - back);
        any_front_ |= height > 0;
    }
    steps_.clear();
    origins_.clear();
    first_step_.resize(std::max(first_step_.size(), level.vertices.size()), kNoStep);
    const auto side = [&](std::uint32_t face) { return face == EmitterEdge::kNone ? 0 : int{side_[face]}; };
    for (const EmitterEdge& edge : level.edges) {
        const int times = side(edge.left) - side(edge.right);
        if (times > 0) {
            add(edge.from, edge.to, times);
        } else if (times < 0) {
            add(edge.to, edge.from, -times);
        }
    }
    outline_.clear();
    walk(level, point);
    return !outline_.empty();
}

void Silhouette::add(std::uint32_t from, std::uint32_t to, int times) {
    for (int i = 0; i < times; ++i) {
        steps_.push_back({to, first_step_[from]});
        first_step_[from] = static_cast<std::uint32_t>(steps_.size() - 1);
        origins_.push_back(from);
    }
}

/// As many steps enter a vertex as leave it, so that every walk ends where it began.
void Silhouette::walk(const EmitterLevel& level, const Vec3d& point) {
    const auto direction = [&](std::uint32_t vertex) { return level.vertices[vertex] - point; };
    for (const std::uint32_t origin : origins_) {
        if (first_step_[origin] == kNoStep) {
            continue;
        }
        if (!outline_.empty() && outline_.back() != outline_.front()) {
            outline_.push_back(outline_.front());
        }
        std::uint32_t vertex = origin;
        outline_.push_back(direction(origin));
        while (first_step_[vertex] != kNoStep) {
            const Step& step = steps_[first_step_[vertex]];
            first_step_[vertex] = step.next;
            vertex = step.to;
            outline_.push_back(direction(vertex));
        }
    }
    // A line that is alone closes by itself.
    if (outline_.size() > 1 && outline_.front() == outline_.back()) {
        outline_.pop_back();
    }
}

bool flatten(std::span<const Vec3d> directions, std::vector<Vec3d>& planar) {
    Vec3d axis(0);
    for (const Vec3d& v : directions) {
        const double length = glm::length(v);
        if (!(length > 0)) {
            return false;
        }
        axis += v / length;
    }
    const double length = glm::length(axis);
    if (!(length > 0)) {
        return false;
    }
    axis /= length;
    planar.clear();
    for (const Vec3d& v : directions) {
        const double height = glm::dot(v, axis);
        if (!(height > kLeastCosine * glm::length(v))) {
            return false;
        }
        planar.push_back(v / height);
    }
    return true;
}

}  // namespace shlight
