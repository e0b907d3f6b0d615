// SPDX-License-Identifier: MIT
//
// Directions to the faces of an emitter, drawn by what each can bring to a hit.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include <glm/vec2.hpp>

#include "base/shading_frame.h"
#include "emitters/face_tree.h"
#include "lights/polygon_sampling.h"
#include "shlight/types.h"

namespace shlight {

/// A direction to a face.
struct FaceSample {
    Vec3d direction;  ///< unit, in the shading frame
    double density;   ///< with which the sampler draws this direction for the sake of this face, per solid angle
    Rgb radiance;     ///< the face's
    bool hidden;      ///< another face of the emitter is before it
};

/// Descends the faces' tree by the radiance, area and angles of its nodes (Conty Estevez & Kulla 2018, Importance
/// Sampling of Many Lights with Adaptive Tree Splitting).
class FaceSampler {
  public:
    /// error: of the hit's position.
    void reset(const FaceTree& faces, const ShadingFrame& frame, double error);
    /// Nothing if the face that a point of the unit square belongs to is seen edge-on or from behind.
    std::optional<FaceSample> sample(const glm::dvec2& point);
    /// The first face in a direction, if it shines on the hit.
    std::optional<FaceSample> meets(const Vec3d& direction);
    /// Solid angle of the faces, about.
    double solid_angle() const { return solid_angle_; }

  private:
    /// An estimate of what a node brings; it is 0 only if that is nothing.
    double importance(const FaceTree::Node& node) const;
    /// The share of the first of two children that are neighbours.
    double share_of_first(std::uint32_t first_child) const;
    /// The probability of the face at this place of the tree.
    double probability(std::uint32_t leaf) const;
    /// Whether distances and angles differ over a face, so that it is drawn evenly over its solid angle above the
    /// horizon; others are drawn evenly over their area.
    bool is_near(const FaceTree::Face& face) const;
    /// Lets polygon_ be a near face.
    void look_at(const FaceTree::Face& face);
    /// A way to a face from a point of the unit square, and its density per solid angle; 0 where it does not shine.
    std::pair<Vec3d, double> way_to(const FaceTree::Face& face, const glm::dvec2& point);
    /// Density of a way to a point of a face that is drawn evenly over its area; 0 where it does not shine.
    double density_over(const FaceTree::Face& face, const Vec3d& way) const;

    const FaceTree* faces_ = nullptr;
    ShadingFrame frame_{};
    FaceViewpoint viewpoint_{};
    double solid_angle_ = 0;
    PolygonSampler polygon_;
};

}  // namespace shlight
