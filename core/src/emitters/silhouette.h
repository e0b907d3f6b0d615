// SPDX-License-Identifier: MIT
//
// The outline of an emissive mesh as seen from a point.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "emitters/emitter_levels.h"
#include "shlight/types.h"

namespace shlight {

/// Finds outlines; memory is reused.
class Silhouette {
  public:
    /// Finds the silhouette of a convex surface. An edge between two faces that both show the point their outer side is
    /// passed once in each direction and cancels; the remaining edges are those where the surface turns away. They
    /// enclose all faces whose outer side is visible. Returns false if there is none: the point is inside, or every
    /// face is seen edge-on.
    bool find(const EmitterLevel& level, const Vec3d& point);

    /// Closed lines that pass no vertex twice, relative to the point, one after the other; counter-clockwise, as seen
    /// from the point, around faces that show it their outer side.
    std::span<const Vec3d> directions() const { return directions_; }
    /// Index past the last vertex of each line.
    std::span<const std::size_t> ends() const { return ends_; }
    /// Whether some face shows its outer side.
    bool any_front() const { return any_front_; }

  private:
    void find_steps(const EmitterLevel& level, const EdgeBlock& block, const Vec3d& point);
    void add(std::uint32_t from, std::uint32_t to);
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
