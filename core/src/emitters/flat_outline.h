// SPDX-License-Identifier: MIT
//
// Outlines of emissive meshes as closed lines in a plane in front of a point.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "shlight/types.h"

namespace shlight {

/// Closed lines in the plane at distance 1 along an axis. Memory is reused.
class FlatOutline {
  public:
    /// The position of a vertex in the plane, and its distance along the axis before projection.
    struct Vertex {
        glm::dvec2 at;
        double depth;
    };

    /// Projects positions relative to the point; `ends` holds the index past the last vertex of each line. The axis is
    /// in the middle of the positions. Returns false, with an unusable outline, unless all positions are in one half of
    /// space, well away from its border.
    bool draw(std::span<const Vec3d> positions, std::span<const std::size_t> ends);

    const Vec3d& axis() const { return axis_; }
    /// The point of the plane in a direction that is in front of it.
    glm::dvec2 shown(const Vec3d& direction) const {
        return glm::dvec2(glm::dot(direction, along_), glm::dot(direction, across_)) / glm::dot(direction, axis_);
    }
    /// The direction to a point of the plane.
    Vec3d direction(const glm::dvec2& at) const { return axis_ + at.x * along_ + at.y * across_; }
    std::size_t line_count() const { return ends_.size(); }
    std::span<const Vertex> line(std::size_t i) const;
    /// Signed area of all lines; positive if they run counter-clockwise, as seen from the point.
    double area() const;

    /// Removes vertices, replacing two by one so that the area is kept, and lines that enclose almost nothing. Regions
    /// that change sides have an area, hence a solid angle, below `most`, counted with multiplicity, and each is close
    /// to one of the opposite sign. Removed lines have no opposite, so their areas count 1 / one_sided times.
    void thin_out(double most, double one_sided);

    /// Joins all lines to one, by an edge from each to the first one and back.
    void join();

  private:
    double enclosed() const;
    double drop_small_lines(double most);

    Vec3d axis_{0}, along_{0}, across_{0};
    std::vector<Vertex> vertices_, joined_;
    std::vector<std::size_t> ends_;
};

}  // namespace shlight
