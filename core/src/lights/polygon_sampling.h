// SPDX-License-Identifier: MIT
//
// Directions to a polygon, as light_sampling.h describes samplers.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "math/light_sample.h"
#include "shlight/mesh.h"
#include "shlight/types.h"

namespace shlight {

/// Points uniform in solid angle (Arvo 1995, "Stratified sampling of spherical triangles"): the first coordinate cuts
/// off a triangle (a, b, c') of that share of the area, the second picks a point on the arc from b to c'.
class SphericalTriangle {
  public:
    /// Corners of any length > 0.
    SphericalTriangle(const Vec3d& a, const Vec3d& b, const Vec3d& c);
    Vec3d sample(const glm::dvec2& point) const;

  private:
    Vec3d a_, b_;
    Vec3d towards_c_;  // at right angles to a
    double area_, alpha_, cos_alpha_, sin_alpha_;
};

/// Whether a line through the origin meets a triangle, in either winding.
inline bool line_meets(const Vec3d& direction, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const double ab = glm::dot(direction, glm::cross(a, b));
    const double bc = glm::dot(direction, glm::cross(b, c));
    const double ca = glm::dot(direction, glm::cross(c, a));
    return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
}

/// Uniform in solid angle over each triangle; triangles that are about equally far everywhere are sampled by area.
class PolygonSampler {
  public:
    /// A planar polygon in the shading frame, with its triangles and its unit normal. Keeps its memory.
    void reset(std::span<const Vec3d> corners, std::span<const Triangle> triangles, const Vec3d& normal);
    /// A planar quadrilateral in the shading frame.
    void reset(const std::array<Vec3d, 4>& corners);
    /// A convex planar polygon in the shading frame, with its unit normal.
    void reset(std::span<const Vec3d> corners, const Vec3d& normal);
    /// Where nothing lies above the horizon, a sample of no weight and no distance.
    LightSample sample(glm::dvec2 point) const;
    /// Parts that are smooth images of the unit square, and a point of one of them; weights as if it were the light.
    std::size_t patch_count() const { return pieces_.size(); }
    LightSample sample_patch(std::size_t patch, const glm::dvec2& point) const;
    /// Above the horizon.
    double solid_angle() const { return total_; }
    /// As CapSampler::meets.
    std::optional<double> meets(const Vec3d& direction) const;

  private:
    struct Piece {
        Vec3d a, b, c;
        double solid_angle;
        double area;                                 // where it is sampled by area
        std::optional<SphericalTriangle> spherical;  // where it is not
    };
    LightSample sample(const Piece& piece, const glm::dvec2& point) const;
    void start(const Vec3d& normal, const Vec3d& corner);
    void add_clipped(const Vec3d& a, const Vec3d& b, const Vec3d& c);

    std::vector<Piece> pieces_;
    double total_ = 0;
    Vec3d normal_{0};
    double height_ = 0;  // of the plane over the hit, along the normal
};

}  // namespace shlight
