// SPDX-License-Identifier: MIT
//
// Directions to a mesh that shines, as light_sampling.h describes samplers.
#pragma once

#include <optional>
#include <vector>

#include <glm/vec2.hpp>

#include "emitters/flat_outline.h"
#include "emitters/mesh_view.h"
#include "lights/cap_sampling.h"
#include "lights/polygon_sampling.h"
#include "lights/seen_light.h"
#include "math/light_sample.h"
#include "shlight/types.h"

namespace shlight {

/// Directions to a mesh: of those to a rectangle about its outline, the ones that lie inside; others have no weight.
/// How far its surface is in a direction is not known: rays tell.
class MeshSampler {
  public:
    void reset(const MeshLight& light, const ShadingFrame& frame);
    /// As reset, with the outline of the last hit that was looked from if this one is close to that, as the light's
    /// distance goes: what was its edge is hardly less so from here. The same light as before.
    void move(const MeshLight& light, const ShadingFrame& frame);
    LightSample sample(const glm::dvec2& point) const;
    /// Of what directions are drawn from.
    double solid_angle() const { return around_ ? around_->solid_angle() : rectangle_.solid_angle(); }
    /// An infinite distance.
    std::optional<double> meets(const Vec3d& direction) const;
    /// How many layers of the mesh lie in a direction, of those that its outline counts.
    int layers(const Vec3d& direction) const;

  private:
    void keep(const ShadingFrame& frame);
    void enclose();

    MeshView view_;
    MeshView::Kind kind_ = MeshView::Kind::hidden;
    bool convex_ = false;               // whose coarse outlines may fold, but not its own
    std::optional<CapSampler> around_;  // where there is no outline
    Vec3d looked_from_{0};
    double shrink_ = 0;                // of the outline, about its middle
    std::vector<Vec3d> edge_;          // the outline in space
    std::vector<Vec3d> local_;         // from the hit
    FlatOutline plane_;                // the outline from the hit, before it was shrunk
    std::vector<glm::dvec2> outline_;  // in that plane
    PolygonSampler rectangle_;
};

}  // namespace shlight
