// SPDX-License-Identifier: MIT
//
// Cells of the world: cubes of a lattice for each power of two. Light that is kept by them stands where it stood when
// the camera moves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include <glm/vec2.hpp>

#include "shlight/ray_tracer.h"
#include "shlight/scene.h"
#include "shlight/surface_point.h"
#include "shlight/types.h"

namespace shlight {

/// A cube for surfaces of one material that are turned to the same side of the world.
struct WorldCell {
    std::uint64_t place;  ///< the cube's size and, in an order in which neighbours are near, its place
    std::uint32_t kind;   ///< of the surface

    bool operator==(const WorldCell&) const = default;
};

/// Random bits that belong to a cell.
struct WorldCellHash {
    std::size_t operator()(const WorldCell& cell) const;
};

class WorldLattice {
  public:
    /// Edges of cells are 2^level, at most this size [m].
    static int level(double size);

    /// scene: must outlive this.
    explicit WorldLattice(const CompiledScene& scene) : scene_(&scene) {}

    /// view: a number below 15 that tells cells of the same place apart.
    WorldCell cell(const SurfacePoint& point, int level, std::uint32_t view = 0) const;
    /// The middle of the point's cell [m].
    Vec3d middle(const SurfacePoint& point, int level) const;
    /// The surface where the point's has a place in the column of its cell, which goes along the axis that the surface
    /// is turned to: the same for all points near it. None if that is another surface, or is hidden from the point.
    /// place: across the column, of its width; the middle is 0.5.
    std::optional<SurfacePoint> surface(const SurfacePoint& point, int level, const glm::dvec2& place) const;

  private:
    glm::i64vec3 corner(const SurfacePoint& point, int level) const;

    const CompiledScene* scene_;
};

}  // namespace shlight
