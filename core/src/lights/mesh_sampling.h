// SPDX-License-Identifier: MIT
//
// Directions to a convex emissive mesh; light_sampling.h says what samplers do.
#pragma once

#include <optional>
#include <vector>

#include <glm/vec2.hpp>

#include "emitters/flat_outline.h"
#include "emitters/mesh_view.h"
#include "lights/cap_sampling.h"
#include "lights/local_light.h"
#include "lights/polygon_sampling.h"
#include "math/light_sample.h"
#include "shlight/types.h"

namespace shlight {

/// Samples the rectangle that encloses the mesh's outline; directions outside of the outline have weight 0. The
/// distance to the surface is not known here: rays find it.
class MeshSampler {
  public:
    void reset(const MeshLight& light, const ShadingFrame& frame);
    /// reset() for the same light, which keeps the outline if the hit moved little compared to the light's distance:
    /// the mesh's contour then changes little.
    void move(const MeshLight& light, const ShadingFrame& frame);
    LightSample sample(const glm::dvec2& point) const;
    /// Solid angle of the region from which directions are drawn.
    double solid_angle() const { return around_ ? around_->solid_angle() : rectangle_.solid_angle(); }
    /// Infinity if the direction meets the mesh.
    std::optional<double> meets(const Vec3d& direction) const;

  private:
    /// Whether the mesh lies in a direction.
    bool covers(const Vec3d& direction) const;
    void keep(const ShadingFrame& frame);
    void enclose();

    MeshView view_;
    MeshView::Kind kind_ = MeshView::Kind::hidden;
    std::optional<CapSampler> around_;  // used if there is no outline
    Vec3d looked_from_{0};
    double shrink_ = 0;                // share by which the outline is shrunk about its middle
    std::vector<Vec3d> edge_;          // the outline in world space
    std::vector<Vec3d> local_;         // the same in the shading frame
    FlatOutline plane_;                // the outline in the plane of projection, before shrinking
    std::vector<glm::dvec2> outline_;  // the shrunk outline in that plane
    PolygonSampler rectangle_;
};

}  // namespace shlight
