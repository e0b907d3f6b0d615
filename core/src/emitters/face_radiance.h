// SPDX-License-Identifier: MIT
//
// Emitters whose faces differ in radiance, such as textured meshes.
//
// The light of such a surface is that of one of even radiance, times the mean of the faces' radiance weighted by the
// lobe. The faces are leaves of a tree, and a hit descends only where a node's mean has a visible error.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/shading_frame.h"
#include "shlight/lobe_shape.h"
#include "shlight/ray_tracer.h"
#include "shlight/types.h"

namespace shlight {

/// Some faces of an emitter.
struct FacePart {
    Vec3d center;  ///< of their area
    double radius;
    Vec3d area_vector;  ///< sum of area · normal
    glm::dmat3 power;   ///< for each colour channel the sum of radiance · area · normal
    double area;
    Rgb radiance;       ///< the mean by area
    double deviation;   ///< root mean square of the faces' radiance about it
    double slope;       ///< the mean of (radiance - mean) · (place - center) ÷ radius, 0 … deviation
    double difference;  ///< of the mean from the emitter's
    double unlike;      ///< 0 … 1: 1 - |area_vector| ÷ area
    double bend;        ///< no normal is farther, as a vector of length 1, from that of area_vector
};

/// Immutable; any number of threads may read it.
class FaceRadiance {
  public:
    /// In the world frame; radiance: one for each triangle. only_outer: see EmitterLevels.
    /// Throws what TriangleTree throws.
    FaceRadiance(std::span<const Vec3d> vertices, std::span<const Triangle> triangles, std::vector<Rgb> radiance,
                 bool only_outer, const Stopped& stopped = {});

    /// Mean radiance by area.
    const Rgb& mean() const { return nodes_.front().part.radiance; }
    /// Appends the radiance of the face that each ray meets, if only_outer on that side, as if nothing else were in its
    /// way; mean() for a miss.
    void along(std::span<const Ray> rays, std::vector<Rgb>& radiance) const;

  private:
    friend class FaceMean;

    static constexpr std::uint32_t kLeaf = 0xFFFFFFFFU;

    struct Node {
        FacePart part;
        std::uint32_t first_child, face;  ///< children are neighbours; kLeaf: there is one face
    };

    struct Face {
        Vec3d a, b, c;
        Rgb radiance;
    };

    /// Sets the part's members that tell how its faces differ.
    void find_variation(std::uint32_t first, std::uint32_t last, FacePart& part) const;
    void build(std::uint32_t node, std::uint32_t first, std::uint32_t last, const Stopped& stopped);

    std::vector<Face> faces_;
    std::vector<Node> nodes_;
    bool only_outer_;
    std::vector<Rgb> of_triangle_;
    std::vector<Vec3f> normals_;  // of each triangle, of any length
    std::unique_ptr<const RayTracer> rays_;
};

/// The mean radiance of the faces that a hit sees. Memory is reused; one per thread.
class FaceMean {
  public:
    /// The mean weighted with f·cos of a lobe, not a mirror, for a viewer in the direction `view` of the frame. value:
    /// the radiance reflected if the emitter has unit radiance; tolerance: relative to the result.
    Rgb of(const FaceRadiance& faces, const LobeShape& shape, const Vec3d& view, const ShadingFrame& frame,
           double value, double tolerance);

  private:
    struct Weighed {
        double weight;  // solid angle times f·cos
        Vec3d light;    // the same times radiance
        double error;   // of the light, if the part counts as a whole
    };

    Weighed weigh(const FacePart& part) const;
    bool suffices(const Weighed& weighed) const;
    void add(const Weighed& weighed);
    /// A face or a part of one, quartered at most this many more times.
    void add_face(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Rgb& radiance, int quarterings);

    const FaceRadiance* faces_ = nullptr;
    const LobeShape* lobe_ = nullptr;
    const ShadingFrame* frame_ = nullptr;
    Vec3d view_{0}, brightest_{0};  // brightest: where f·cos is largest, about
    double width_ = 1;
    double light_ = 0, allowed_ = 0;
    Vec3d sum_{0};
    double weights_ = 0;
    std::vector<std::uint32_t> open_;
};

}  // namespace shlight
