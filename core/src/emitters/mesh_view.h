// SPDX-License-Identifier: MIT
//
// The directions in which a hit sees an emissive mesh, in the hit's shading frame.
#pragma once

#include <span>
#include <vector>

#include "emitters/emitter_levels.h"
#include "emitters/flat_outline.h"
#include "emitters/silhouette.h"
#include "shlight/types.h"
#include "tracing/hits.h"

namespace shlight {

/// Views of one convex mesh after another; memory is reused.
class MeshView {
  public:
    enum class Kind {
        hidden,
        outline,  ///< the region inside outline()
        faces,    ///< the region of all faces(): the outline is almost half of space
        inside    ///< all directions: the surface surrounds the hit
    };

    /// tolerance: error as radiance of a white surface.
    Kind look(const EmitterLevels& emitter, const ShadingFrame& frame, double tolerance);

    /// One line, counter-clockwise as seen from the hit; separate lines are joined by edges that are passed in both
    /// directions.
    const FlatOutline& outline() const { return outline_; }
    /// Faces, three corners each, with either winding.
    std::span<const Vec3d> faces() const { return faces_; }
    /// Distance between the level in use and the mesh [m].
    double error() const { return error_; }

  private:
    Kind look_at_faces(const EmitterLevel& level, const Vec3d& point, const ShadingFrame& frame);

    Silhouette silhouette_;
    FlatOutline outline_;
    std::vector<Vec3d> local_, faces_;
    double error_ = 0;
};

}  // namespace shlight
