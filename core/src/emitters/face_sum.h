// SPDX-License-Identifier: MIT
//
// The radiance that lobes reflect of an emitter's faces if nothing is before them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/shading_frame.h"
#include "emitters/face_tree.h"
#include "shlight/lobe_shape.h"
#include "shlight/types.h"

namespace shlight {

/// A lobe of a hit, no mirror.
struct SummedLobe {
    LobeShape shape;
    double weight;   ///< largest channel of the colour that multiplies it, ≥ 0
    Vec3d light{0};  ///< the radiance that it reflects without its colour
};

/// A face that is so near, or so large beside a lobe, that its light is to be integrated exactly.
struct NearFace {
    std::array<Vec3d, 3> corners;  ///< in the shading frame
    Rgb radiance;
};

/// Sums up a cut through the tree, which is refined where its errors are largest (Walter et al. 2005, Lightcuts). The
/// lobes of a hit share the cut. Memory is reused; one per thread.
class FaceSum {
  public:
    /// Sets the lobes' light. view: the viewer's direction in the frame. viewpoint: of the frame's origin. tolerance:
    /// error of the weighted sum over the lobes ÷ that sum; absolute: of the sum, if that is more. Faces that are too
    /// near are appended to `near`, and are missing in the light.
    void add_up(const FaceTree& faces, const Vec3d& view, const ShadingFrame& frame, const FaceViewpoint& viewpoint,
                double tolerance, double absolute, std::span<SummedLobe> lobes, std::vector<NearFace>& near);

  private:
    struct Part {
        Vec3d light;        // from there, without lobes
        double value;       // weighted sum of the lobes' f·cos
        double error;       // of the sum, if the part counts as a whole
        std::size_t first;  // in values_, one for each lobe
        std::uint32_t node;
    };

    /// A part that the hit sees, before its lobes are known.
    struct SeenPart {
        Vec3d direction;  // in the world
        Vec3d light;
        double brought;  // visible area ÷ the square of the distance
        double width;
        bool level;  // with the horizon
        bool one_side;
        std::uint32_t node;
    };

    /// Directions to parts, in the world and of any length, and a lobe's f·cos for them, up to the next multiple of
    /// kLobeRayLanes.
    struct Ways {
        std::vector<float> x, y, z, values;

        void resize(std::size_t count);
        void set(std::size_t i, const Vec3d& way);
        void weigh(const LobeShape& shape, const ShadingFrame& frame, const Vec3d& view, std::size_t count);
    };

    /// Finds what the hit sees of the opened nodes, and of those below them that are not too wide.
    void look();
    SeenPart seen_part(std::uint32_t node, const PartView& seen) const;
    /// Adds what was seen to the cut.
    void weigh();
    void weigh(std::size_t lobe, Part* parts);
    /// Finds the largest values of f·cos that the parts may meet, about: in the directions nearest to a lobe's
    /// brightest.
    void find_most(const SummedLobe& lobe);
    /// Opens the parts whose errors are above the mean of those that are allowed.
    void open_worst(double allowed, Vec3d& near_light, std::vector<NearFace>& near);
    void open(std::uint32_t node);
    void add_near(const FaceTree::Face& face, std::vector<NearFace>& near) const;

    const FaceTree* faces_ = nullptr;
    const ShadingFrame* frame_ = nullptr;
    std::span<SummedLobe> lobes_;
    Vec3d view_{0};
    const FaceViewpoint* viewpoint_ = nullptr;
    std::vector<std::uint32_t> opened_;
    std::vector<SeenPart> seen_;
    Ways ways_;                        // of these
    Ways nearest_;                     // of some of these, towards a lobe's brightest direction
    std::vector<std::uint32_t> some_;  // their numbers
    std::vector<float> most_;          // of all
    std::vector<Part> cut_;
    std::vector<float> values_;
};

}  // namespace shlight
