// SPDX-License-Identifier: MIT
//
// Directions to a mesh that shines, as light_sampling.h describes samplers.
#pragma once

#include <optional>
#include <vector>

#include <glm/vec2.hpp>

#include "cap_sampling.h"
#include "light_sample.h"
#include "light_view.h"
#include "mesh_view.h"
#include "polygon_sampling.h"
#include "shlight/types.h"

namespace shlight {

/// Directions to a mesh: of those to a rectangle about its outline, the ones that lie inside; others have no weight.
/// How far its surface is in a direction is not known: rays tell.
class MeshSampler {
  public:
    void reset(const MeshLight& light, const ShadingFrame& frame);
    LightSample sample(const glm::dvec2& point) const;
    /// Of what directions are drawn from.
    double solid_angle() const { return around_ ? around_->solid_angle() : rectangle_.solid_angle(); }
    /// An infinite distance.
    std::optional<double> meets(const Vec3d& direction) const;
    /// How many layers of the mesh lie in a direction, of those that its outline counts.
    int layers(const Vec3d& direction) const;

  private:
    void enclose(double shrink);

    MeshView view_;
    MeshView::Kind kind_ = MeshView::Kind::hidden;
    bool convex_ = false;               // whose coarse outlines may fold, but not its own
    std::optional<CapSampler> around_;  // where there is no outline
    PolygonSampler rectangle_;
    Vec3d axis_{0}, along_{0}, across_{0};  // of the outline's plane at distance 1
    std::vector<glm::dvec2> outline_;       // in that plane
};

}  // namespace shlight
