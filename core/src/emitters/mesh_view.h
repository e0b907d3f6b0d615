// SPDX-License-Identifier: MIT
//
// An emissive mesh as a hit sees it, in its shading frame.
#pragma once

#include <span>
#include <vector>

#include "emitters/emitter_levels.h"
#include "emitters/flat_outline.h"
#include "emitters/silhouette.h"
#include "shlight/types.h"
#include "tracing/hits.h"

namespace shlight {

/// Looks at one mesh after the other; keeps its memory.
class MeshView {
  public:
    enum class Kind {
        hidden,
        outline,  ///< the region inside outline()
        faces,    ///< that of each of faces(): the outline is wider than half of space, or the mesh is around it
        inside    ///< all directions: the hit lies within a closed surface
    };

    /// tolerance: of the radiance of a white surface.
    Kind look(const EmitterLevels& emitter, const ShadingFrame& frame, double tolerance);

    /// One line, counter-clockwise as seen from the hit; lines that are apart are joined by edges that are passed in
    /// both directions.
    const FlatOutline& outline() const { return outline_; }
    /// Three corners each, either way round.
    std::span<const Vec3d> faces() const { return faces_; }
    /// Between the level that was looked at and the mesh [m].
    double error() const { return error_; }

  private:
    Kind look_at_faces(const EmitterLevel& level, const Vec3d& point, const ShadingFrame& frame, bool front_only);

    Silhouette silhouette_;
    FlatOutline outline_;
    std::vector<Vec3d> local_, faces_;
    double error_ = 0;
};

}  // namespace shlight
