// SPDX-License-Identifier: MIT
//
// Closed lines about what a point sees, drawn in a plane before it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "shlight/types.h"

namespace shlight {

/// Closed lines in the plane at distance 1 along an axis. Keeps its memory from one to the next.
class FlatOutline {
  public:
    /// A vertex as the plane shows it, and how far along the axis what it shows is.
    struct Vertex {
        glm::dvec2 at;
        double depth;
    };

    /// Draws positions relative to the point, `ends` of each line being past its last one, where the plane shows them;
    /// the axis is in their middle. False, and the outline is of no use, if they do not all lie in one half of space,
    /// well away from its border.
    bool draw(std::span<const Vec3d> positions, std::span<const std::size_t> ends);

    const Vec3d& axis() const { return axis_; }
    /// Where the plane shows a direction before it.
    glm::dvec2 shown(const Vec3d& direction) const {
        return glm::dvec2(glm::dot(direction, along_), glm::dot(direction, across_)) / glm::dot(direction, axis_);
    }
    /// What the plane shows there.
    Vec3d direction(const glm::dvec2& at) const { return axis_ + at.x * along_ + at.y * across_; }
    std::size_t line_count() const { return ends_.size(); }
    std::span<const Vertex> line(std::size_t i) const;
    /// Of all lines; positive if they run counter-clockwise about what they enclose, as seen from the point.
    double area() const;

    /// Takes away vertices, two at a time with one in their place so that the area stays the same, and lines that
    /// enclose next to nothing. What lies on another side of a line than before has an area, hence a solid angle, below
    /// `most`, counted as often as it changes sides, and no part of it is far from one of the opposite sign. Lines that
    /// go have no opposite, so that their areas count 1 / one_sided times.
    void thin_out(double most, double one_sided);

    /// Makes one line of all: from each of the others there is an edge to the first one and back.
    void join();

  private:
    double enclosed() const;
    double drop_small_lines(double most);

    Vec3d axis_{0}, along_{0}, across_{0};
    std::vector<Vertex> vertices_, joined_;
    std::vector<std::size_t> ends_;
};

}  // namespace shlight
