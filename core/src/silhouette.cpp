// SPDX-License-Identifier: MIT
#include "silhouette.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace shlight {
namespace {

constexpr std::uint32_t kNoStep = EmitterEdge::kNone;
/// Relative to the distance, of a point from planes that it is surely on one side of.
constexpr double kSideMargin = 1e-9;
/// Cosine to the axis of the half space that a flattened outline keeps at least.
constexpr double kLeastCosine = 0.02;

/// Where a point is in relation to all planes of a block.
enum class Side { front, back, both };

/// A normal at an angle of at most θ to the axis is at φ ± θ to the direction to the point, if φ is the axis' angle to
/// it. Well away from the planes, so that rounding never makes two blocks differ over a face.
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

/// Areas that a step of thinning may move, as parts of what all may.
constexpr std::array<double, 2> kLimits = {1.0 / 64, 1.0 / 16};
/// Vertices that are left at least.
constexpr std::size_t kLeastVertices = 8;

/// The point beside the middle of b and c for which a, e, d encloses the same area as a, b, c, d.
std::optional<Vec3d> replacement(const Vec3d& normal, const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    const Vec3d chord = d - a;
    const double square = glm::dot(chord, chord);
    if (!(square > 0)) {
        return std::nullopt;
    }
    // Twice the area; that of a, e, d is e's height over the chord times its length.
    const double area = glm::dot(normal, glm::cross(b - a, c - a) + glm::cross(c - a, chord));
    const double along = glm::dot(0.5 * (b + c) - a, chord) / square;
    return a + along * chord - (area / square) * glm::cross(normal, chord);
}

/// Between two lines from a to d.
double moved_area(const Vec3d& normal, const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d, const Vec3d& e) {
    const auto area = [&](const Vec3d& p, const Vec3d& q) {
        return 0.5 * std::abs(glm::dot(normal, glm::cross(p - e, q - e)));
    };
    return area(a, b) + area(b, c) + area(c, d);
}

}  // namespace

bool Silhouette::find(const EmitterLevel& level, bool closed, const Vec3d& point) {
    any_front_ = false;
    steps_.clear();
    origins_.clear();
    first_step_.resize(std::max(first_step_.size(), level.vertices.size()), kNoStep);
    for (const EdgeBlock& block : level.blocks) {
        switch (side_of(block, point)) {
            case Side::front:
                any_front_ = true;
                break;
            case Side::back:
                break;
            case Side::both:
                find_steps(level, block, closed, point);
                break;
        }
    }
    outline_.clear();
    walk(level, point);
    return !outline_.empty();
}

void Silhouette::find_steps(const EmitterLevel& level, const EdgeBlock& block, bool closed, const Vec3d& point) {
    const auto side = [&](std::uint32_t face) {
        if (face == EmitterEdge::kNone) {
            return 0;
        }
        const double height = glm::dot(level.planes[face].normal, point) - level.planes[face].height;
        any_front_ |= height > 0;
        return int{height > 0} - (closed ? 0 : int{height < 0});
    };
    for (std::size_t i = block.first; i < block.last; ++i) {
        const EmitterEdge& edge = level.edges[i];
        const int times = side(edge.left) - side(edge.right);
        if (times > 0) {
            add(edge.from, edge.to, times);
        } else if (times < 0) {
            add(edge.to, edge.from, -times);
        }
    }
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
    is_simple_ = true;
    for (const std::uint32_t origin : origins_) {
        if (first_step_[origin] == kNoStep) {
            continue;
        }
        if (!outline_.empty()) {
            is_simple_ = false;
            if (outline_.back() != outline_.front()) {
                outline_.push_back(outline_.front());
            }
        }
        std::uint32_t vertex = origin;
        outline_.push_back(direction(origin));
        while (first_step_[vertex] != kNoStep) {
            const Step& step = steps_[first_step_[vertex]];
            first_step_[vertex] = step.next;
            is_simple_ = is_simple_ && step.next == kNoStep;
            vertex = step.to;
            outline_.push_back(direction(vertex));
        }
    }
    // A line that is alone closes by itself.
    if (outline_.size() > 1 && outline_.front() == outline_.back()) {
        outline_.pop_back();
    }
}

std::optional<Vec3d> flatten(std::span<const Vec3d> directions, std::vector<Vec3d>& planar) {
    Vec3d axis(0);
    for (const Vec3d& v : directions) {
        const double length = glm::length(v);
        if (!(length > 0)) {
            return std::nullopt;
        }
        axis += v / length;
    }
    const double length = glm::length(axis);
    if (!(length > 0)) {
        return std::nullopt;
    }
    axis /= length;
    planar.clear();
    for (const Vec3d& v : directions) {
        const double height = glm::dot(v, axis);
        if (!(height > kLeastCosine * glm::length(v))) {
            return std::nullopt;
        }
        planar.push_back(v / height);
    }
    return axis;
}

void thin_out(const Vec3d& normal, double most, std::vector<Vec3d>& line) {
    double spent = 0;
    // The least harmful first: a step costs about as the cube of its length.
    for (const double share : kLimits) {
        const double limit = share * most;
        for (std::size_t i = 0; i < line.size() && line.size() > kLeastVertices; ++i) {
            const std::size_t count = line.size();
            const auto after = [&](std::size_t k) { return k + 1 < count ? k + 1 : 0; };
            const std::size_t second = after(i);
            const std::size_t third = after(second);
            const Vec3d& a = line[i];
            const Vec3d& b = line[second];
            const Vec3d& c = line[third];
            const Vec3d& d = line[after(third)];
            const std::optional<Vec3d> e = replacement(normal, a, b, c, d);
            const double moved = e ? moved_area(normal, a, b, c, d, *e) : limit;
            if (moved < limit && spent + moved < most) {
                spent += moved;
                line[second] = *e;
                line.erase(line.begin() + static_cast<std::ptrdiff_t>(third));
            }
        }
    }
}

}  // namespace shlight
