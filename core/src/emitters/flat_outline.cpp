// SPDX-License-Identifier: MIT
#include "emitters/flat_outline.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/geometric.hpp>

#include "base/perpendicular.h"

namespace shlight {
namespace {

using Point = glm::dvec2;
using Vertex = FlatOutline::Vertex;

/// Least cosine to the axis of an outline's vertices.
constexpr double kLeastCosine = 0.02;
/// Areas that a step of thinning may move ÷ the total allowed: the least harmful steps come first, since the area of a
/// step grows as about the cube of its length.
constexpr std::array<double, 3> kLimits = {1.0 / 64, 1.0 / 16, 1.0 / 16};
/// Largest area that removed lines may enclose together ÷ area of all lines.
constexpr double kNextToNothing = 1e-3;
/// Least number of vertices of a line.
constexpr std::size_t kLeastVertices = 8;

double cross(const Point& a, const Point& b) {
    return a.x * b.y - a.y * b.x;
}

double area_of(std::span<const Vertex> line) {
    double twice = 0;
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        twice += cross(line[i].at - line.front().at, line[i + 1].at - line.front().at);
    }
    return twice / 2;
}

/// A line a, e, d that encloses the same area as a, b, c, d, and the area between the two.
struct Step {
    Point e;
    double moved;
};

/// e is next to the middle of b and c; undefined if a and d are equal.
Step step(const Point& a, const Point& b, const Point& c, const Point& d) {
    const Point chord = d - a;
    // Twice the area; that of a, e, d is e's height over the chord times its length.
    const double area = cross(b - a, c - a) + cross(c - a, chord);
    const double square = glm::dot(chord, chord);
    const double along = glm::dot(0.5 * (b + c) - a, chord) / square;
    const double up = area / square;
    const Point e = a + along * chord + up * Point(chord.y, -chord.x);
    const auto between = [&](const Point& p, const Point& q) { return 0.5 * std::abs(cross(p - e, q - e)); };
    return {e, between(a, b) + between(b, c) + between(c, d)};
}

/// Performs steps around a line, each from the end of the one before, while they move less than the limit and area is
/// left. Returns the number of vertices.
std::size_t walk_around(std::span<Vertex> line, double limit, double& left) {
    std::size_t spare = line.size() - std::min(line.size(), kLeastVertices);
    std::size_t kept = 1;
    std::size_t i = 1;
    while (i < line.size()) {
        if (i + 1 < line.size() && spare > 0) {
            const Vertex& d = line[i + 2 < line.size() ? i + 2 : 0];
            const Step made = step(line[kept - 1].at, line[i].at, line[i + 1].at, d.at);
            if (made.moved <= std::min(limit, left)) {
                left -= made.moved;
                line[kept++] = {made.e, (line[i].depth + line[i + 1].depth) / 2};
                i += 2;
                --spare;
                continue;
            }
        }
        line[kept++] = line[i++];
    }
    return kept;
}

}  // namespace

bool FlatOutline::draw(std::span<const Vec3d> positions, std::span<const std::size_t> ends) {
    axis_ = Vec3d(0);
    for (const Vec3d& v : positions) {
        const double length = glm::length(v);
        if (!(length > 0)) {
            return false;
        }
        axis_ += v / length;
    }
    const double length = glm::length(axis_);
    if (!(length > 0)) {
        return false;
    }
    axis_ /= length;
    along_ = perpendicular(axis_);
    across_ = glm::cross(along_, axis_);  // to the left of along_, as seen from the point
    vertices_.clear();
    for (const Vec3d& v : positions) {
        const double height = glm::dot(v, axis_);
        if (!(height > kLeastCosine * glm::length(v))) {
            return false;
        }
        vertices_.push_back({shown(v), height});
    }
    ends_.assign(ends.begin(), ends.end());
    return true;
}

std::span<const FlatOutline::Vertex> FlatOutline::line(std::size_t i) const {
    const std::size_t first = i > 0 ? ends_[i - 1] : 0;
    return std::span(vertices_).subspan(first, ends_[i] - first);
}

double FlatOutline::area() const {
    double sum = 0;
    for (std::size_t i = 0; i < line_count(); ++i) {
        sum += area_of(line(i));
    }
    return sum;
}

/// Sum of the absolute areas of all lines.
double FlatOutline::enclosed() const {
    double sum = 0;
    for (std::size_t i = 0; i < line_count(); ++i) {
        sum += std::abs(area_of(line(i)));
    }
    return sum;
}

void FlatOutline::thin_out(double most, double one_sided) {
    const double gone = drop_small_lines(std::min(most * one_sided / 2, kNextToNothing * enclosed()));
    const double all = enclosed();
    double left = 0;
    std::size_t first = 0;
    std::size_t kept = 0;
    for (std::size_t& end : ends_) {
        std::span<Vertex> line = std::span(vertices_).subspan(first, end - first);
        left += (most - gone / one_sided) * std::abs(area_of(line)) / all;
        for (const double share : kLimits) {
            line = line.first(walk_around(line, share * most, left));
        }
        for (const Vertex& v : line) {
            vertices_[kept++] = v;
        }
        first = end;
        end = kept;
    }
    vertices_.resize(kept);
}

/// Returns the area of removed lines.
double FlatOutline::drop_small_lines(double most) {
    double gone = 0;
    std::size_t first = 0;
    std::size_t kept = 0;
    std::size_t lines = 0;
    for (const std::size_t end : ends_) {
        const std::span<const Vertex> line = std::span(vertices_).subspan(first, end - first);
        first = end;
        const double area = std::abs(area_of(line));
        if (gone + area <= most) {
            gone += area;
            continue;
        }
        for (const Vertex& v : line) {
            vertices_[kept++] = v;
        }
        ends_[lines++] = kept;
    }
    vertices_.resize(kept);
    ends_.resize(lines);
    return gone;
}

void FlatOutline::join() {
    if (line_count() < 2) {
        return;
    }
    joined_.clear();
    for (std::size_t i = 0; i < line_count(); ++i) {
        const std::span<const Vertex> one = line(i);
        joined_.insert(joined_.end(), one.begin(), one.end());
        joined_.push_back(one.front());
        // The way back from the last line closes the joined line.
        if (i > 0 && i + 1 < line_count()) {
            joined_.push_back(joined_.front());
        }
    }
    std::swap(vertices_, joined_);
    ends_.assign(1, vertices_.size());
}

}  // namespace shlight
