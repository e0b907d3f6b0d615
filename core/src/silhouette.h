// SPDX-License-Identifier: MIT
//
// The outline inside which a point sees an emissive mesh.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "emitter_levels.h"
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

    /// One closed line, counter-clockwise as seen from the point, relative to the point; separate lines are joined by
    /// edges that are passed in both directions.
    std::span<const Vec3d> outline() const { return outline_; }
    /// Whether the outline is one line by itself that passes no vertex twice.
    bool is_simple() const { return is_simple_; }
    /// Whether some face shows its outer side.
    bool any_front() const { return any_front_; }

  private:
    void find_steps(const EmitterLevel& level, const EdgeBlock& block, bool closed, const Vec3d& point);
    void add(std::uint32_t from, std::uint32_t to, int times);
    void walk(const EmitterLevel& level, const Vec3d& point);

    struct Step {
        std::uint32_t to, next;  // next: of the same origin
    };
    std::vector<Step> steps_;
    std::vector<std::uint32_t> first_step_;  // of each vertex
    std::vector<std::uint32_t> origins_;
    std::vector<Vec3d> outline_;
    bool any_front_ = false;
    bool is_simple_ = false;
};

/// Moves the vertices along their directions into a plane at distance 1, where they enclose the same directions, and
/// returns its normal. Nothing if they do not all lie in one half of space, well away from its border.
std::optional<Vec3d> flatten(std::span<const Vec3d> directions, std::vector<Vec3d>& planar);

/// Takes away vertices of a simple closed line in the plane at distance 1 along a unit normal: two at a time, with one
/// in their place so that the area stays the same. What lies on another side of the line than before has an area, hence
/// a solid angle, below `most`, counted as often as it changes sides, and no part of it is far from one of the opposite
/// sign.
void thin_out(const Vec3d& normal, double most, std::vector<Vec3d>& line);

}  // namespace shlight
