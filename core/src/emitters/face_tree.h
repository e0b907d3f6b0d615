// SPDX-License-Identifier: MIT
//
// Emitters that no outline stands for: surfaces that hide parts of themselves, and those whose faces differ in
// radiance.
//
// The faces are leaves of a tree. The light of a surface is that of a cut through the tree, which is fine only where a
// node has a visible error as a whole.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/shading_frame.h"
#include "shlight/lobe_shape.h"
#include "shlight/ray_tracer.h"
#include "shlight/types.h"

namespace shlight {

/// The largest absolute value of the three.
inline double largest_channel(const Vec3d& color) {
    return std::max({std::abs(color.x), std::abs(color.y), std::abs(color.z)});
}

/// Some faces of an emitter.
struct FacePart {
    Vec3d center;  ///< of their area
    double radius;
    Vec3d area_vector;  ///< sum of area · normal
    glm::dmat3 power;   ///< for each colour channel the sum of radiance · area · normal
    glm::dmat3 turns;   ///< sum of area · normal ⊗ normal
    double area;
    Rgb radiance;       ///< the mean by area
    double deviation;   ///< root mean square of the faces' radiance about it
    double slope;       ///< the mean of (radiance - mean) · (place - center) ÷ radius, 0 … deviation
    double shown;       ///< |area_vector|, the area as seen from afar, 0 … area
    double bend;        ///< no normal is farther, as a vector of length 1, from that of area_vector
    double thickness;   ///< no corner is farther from the plane through center across area_vector
    double brightness;  ///< root mean square of the faces' radiance
};

/// The start of rays to faces, and the side of those that shine there.
struct FaceViewpoint {
    Vec3d start;       ///< over a hit: rays from there do not meet the surface that was hit
    double clearance;  ///< of the start: a face from whose plane the hit is no farther is taken to be level with it,
                       ///< and dark; it would cover half of space or nothing, as rounding has it
    bool front_only;   ///< only faces that turn their outer side to it: others are dark there, or hidden by them
};

/// A part as a hit sees it.
struct PartView {
    /// viewpoint: of the frame's origin. is_face: the part is one face.
    PartView(const FacePart& part, const ShadingFrame& frame, const FaceViewpoint& viewpoint, bool is_face);

    Vec3d way;        ///< from the hit
    double distance;  ///< > 0
    double nearness;  ///< 1 ÷ distance
    double width;     ///< radius ÷ distance
    double rise;      ///< sine of the elevation over the horizon
    double facing;    ///< area that it shows the hit; < 0 from behind
    double unclear;   ///< and may show, if its faces do not all turn the same side to the hit
    bool one_side;    ///< they do
    bool hidden;      ///< nothing of it shines on the hit
};

/// Immutable; any number of threads may read it.
class FaceTree {
  public:
    /// In the world frame; radiance: one for each triangle. closed, one_sided: see EmitterLevels.
    /// Throws what SurfaceTree throws.
    FaceTree(std::span<const Vec3d> vertices, std::span<const Triangle> triangles, std::span<const Rgb> radiance,
             bool closed, bool one_sided, const Stopped& stopped = {});

    /// Mean radiance by area.
    const Rgb& mean() const { return nodes_.front().part.radiance; }
    const Vec3d& center() const { return nodes_.front().part.center; }
    /// No place is farther from the center.
    double radius() const { return nodes_.front().part.radius; }
    double area() const { return nodes_.front().part.area; }
    /// error: of the hit's position.
    FaceViewpoint viewpoint(const ShadingFrame& frame, double error) const;
    /// The radiance that comes from a direction, if nothing else is in the way.
    Rgb from(const FaceViewpoint& viewpoint, const Vec3d& direction) const;

  private:
    friend class FaceSum;
    friend class FaceSampler;

    static constexpr std::uint32_t kLeaf = 0xFFFFFFFFU;

    struct Node {
        FacePart part;
        std::uint32_t first_child, face;  ///< children are neighbours; kLeaf: there is one face
    };

    struct Face {
        Vec3d a, b, c;
        Rgb radiance;
        std::uint32_t triangle;
    };

    bool shows_front_only(const Vec3d& point) const;
    /// Whether a ray meets the outer side of a face.
    static bool is_front(const Face& face, const Vec3d& direction);
    /// How far a point is over the outer side of the face's plane; NaN: the face has no area.
    static double height_over(const Face& face, const Vec3d& point);
    /// The faces first … last - 1 of a node are halved here.
    static std::uint32_t middle_of(std::uint32_t first, std::uint32_t last) { return first + (last - first) / 2; }
    /// The first face that a ray meets, from whatever side, or null; the ray starts behind it from then on.
    const Face* next_face(Ray& ray) const;

    /// Sets the part's members that tell how its faces differ.
    void find_variation(std::uint32_t first, std::uint32_t last, FacePart& part) const;
    void build(std::uint32_t node, std::uint32_t first, std::uint32_t last, const Stopped& stopped);

    std::vector<Face> faces_;
    std::vector<std::uint32_t> leaf_of_;  // the place in faces_ of each triangle
    std::vector<Node> nodes_;
    bool closed_, one_sided_;
    std::unique_ptr<const RayTracer> rays_;
};

}  // namespace shlight
