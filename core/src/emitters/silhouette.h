// SPDX-License-Identifier: MIT
//
// The outline inside which a point sees an emissive mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "emitters/emitter_levels.h"
#include "shlight/types.h"

namespace shlight {

/// Finds outlines; keeps its memory from one to the next.
class Silhouette {
  public:
    /// Where two neighbouring faces are seen from the same side, the edge between them is passed once in each direction
    /// and drops out: what is left are the edges where the surface turns away, and its borders. Together they enclose
    /// all faces whose outer side is seen (of closed surfaces; what lies behind is hidden by them, unless the surface
    /// is concave) or all faces, from either side (of others). Where several layers are seen they count as often. False
    /// if there is none: the point lies within a closed surface, or every face is seen edge-on.
    bool find(const EmitterLevel& level, bool closed, const Vec3d& point);

    /// Closed lines that pass no vertex twice, relative to the point, one after the other; counter-clockwise as seen
    /// from there about what shows the point its outer side.
    std::span<const Vec3d> directions() const { return directions_; }
    /// Of each line, past its last vertex.
    std::span<const std::size_t> ends() const { return ends_; }
    /// Whether some face shows its outer side.
    bool any_front() const { return any_front_; }

  private:
    void find_steps(const EmitterLevel& level, const EdgeBlock& block, bool closed, const Vec3d& point);
    void add(std::uint32_t from, std::uint32_t to, int times);
    void walk(std::uint32_t origin, const EmitterLevel& level, const Vec3d& point);
    void cut_off(std::size_t first, const EmitterLevel& level, const Vec3d& point);

    struct Step {
        std::uint32_t to, next;  // next: of the same origin
    };
    std::vector<Step> steps_;
    std::vector<std::uint32_t> first_step_;  // of each vertex
    std::vector<std::uint32_t> origins_;
    std::vector<std::uint32_t> path_;   // vertices passed, none of them twice
    std::vector<std::uint32_t> place_;  // of each vertex in the path
    std::vector<Vec3d> directions_;
    std::vector<std::size_t> ends_;
    bool any_front_ = false;
};

}  // namespace shlight
