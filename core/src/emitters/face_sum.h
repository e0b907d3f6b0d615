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

/// Sums up a cut through the tree, which is refined where its error is largest (Walter et al. 2005, Lightcuts). The
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

    void open(std::uint32_t node);
    Part weigh(std::uint32_t node, const PartView& seen);
    /// The largest value of f·cos that a part may meet, about.
    double most_value(const SummedLobe& lobe, const Vec3d& direction, double width, double value) const;
    void refine(std::vector<NearFace>& near, double tolerance, double absolute);
    void add_near(const FaceTree::Face& face, std::vector<NearFace>& near) const;

    const FaceTree* faces_ = nullptr;
    const ShadingFrame* frame_ = nullptr;
    std::span<SummedLobe> lobes_;
    Vec3d view_{0};
    bool front_only_ = false;
    double clearance_ = 0;   // from the plane of a face, below which the hit is on it
    std::vector<Part> cut_;  // a heap by error
    std::vector<float> values_;
    Vec3d light_{0};      // of the cut, about
    double squares_ = 0;  // of its errors
};

}  // namespace shlight
