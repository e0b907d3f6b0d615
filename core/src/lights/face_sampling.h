// SPDX-License-Identifier: MIT
//
// Directions to the faces of an emitter, drawn by what each can bring to a hit.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

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

/// Descends the faces' tree by the radiance, area and angles of its nodes, from those that are far enough to be judged
/// as a whole (Conty Estevez & Kulla 2018, Importance Sampling of Many Lights with Adaptive Tree Splitting).
class FaceSampler {
  public:
    /// error: of the hit's position.
    void reset(const FaceTree& faces, const ShadingFrame& frame, double error);
    /// Nothing if the face that a point of the unit square belongs to is seen edge-on or from behind.
    std::optional<FaceSample> sample(const glm::dvec2& point);
    /// The faces in a direction above the horizon that shine on the hit if no other is before them, from the nearest
    /// on.
    std::span<const FaceSample> meet(const Vec3d& direction);
    /// Solid angle of the faces, about.
    double solid_angle() const { return solid_angle_; }

  private:
    /// An estimate of what a node brings; it is 0 only if that is nothing.
    double importance(const FaceTree::Node& node) const { return importance(node, view(node)); }
    double importance(const FaceTree::Node& node, const PartView& seen) const;
    PartView view(const FaceTree::Node& node) const {
        return {node.part, frame_, viewpoint_, node.first_child == FaceTree::kLeaf};
    }
    /// The same of a face that is near.
    double importance_of_near(const FaceTree::Node& node) const;
    /// Appends the parts below a node, of the faces first … last - 1, that are not too near to be drawn from as a
    /// whole.
    void split(std::uint32_t node, std::uint32_t first, std::uint32_t last);
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
    /// Density with which a direction, which meets a face, is drawn for its sake; NaN or 0 where it does not shine.
    /// world: the direction there.
    double density_towards(const FaceTree::Face& face, const Vec3d& direction, const Vec3d& world);
    /// Density of a way to a point of a face that is drawn evenly over its area; 0 where it does not shine.
    double density_over(const FaceTree::Face& face, const Vec3d& way) const;

    /// A node, which has the faces first … last - 1.
    struct Part {
        double from, up_to;  // its place in the sum of the importances of all
        std::uint32_t node, first, last;
    };

    const FaceTree* faces_ = nullptr;
    std::vector<Part> parts_;  // that shine on the hit
    std::vector<FaceSample> met_;
    ShadingFrame frame_{};
    FaceViewpoint viewpoint_{};
    double solid_angle_ = 0;
    PolygonSampler polygon_;
};

}  // namespace shlight
