// SPDX-License-Identifier: MIT
//
// Directions to a polygon; light_sampling.h says what samplers do.
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

/// Samples a spherical triangle uniformly in solid angle (Arvo 1995, "Stratified sampling of spherical triangles"): the
/// first coordinate cuts off a triangle (a, b, c') with that share of the area, the second picks a point on the arc
/// from b to c'.
class SphericalTriangle {
  public:
    /// Corners are vectors of any length > 0.
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

/// Samples each triangle uniformly in solid angle, or by area if all its points are about equally far.
class PolygonSampler {
  public:
    /// A planar polygon in the shading frame, with its triangles and unit normal. Memory is reused.
    void reset(std::span<const Vec3d> corners, std::span<const Triangle> triangles, const Vec3d& normal);
    /// A planar quadrilateral in the shading frame.
    void reset(const std::array<Vec3d, 4>& corners);
    /// A convex planar polygon in the shading frame, with its unit normal.
    void reset(std::span<const Vec3d> corners, const Vec3d& normal);
    /// If nothing lies above the horizon, a sample with weight and distance 0.
    LightSample sample(glm::dvec2 point) const;
    /// The weight with which sample() draws a direction; 0 if it does not.
    double weight(const Vec3d& direction) const;
    /// Number of patches, which are smooth images of the unit square; sample_patch() samples one as if it were the
    /// light.
    std::size_t patch_count() const { return pieces_.size(); }
    LightSample sample_patch(std::size_t patch, const glm::dvec2& point) const;
    /// Solid angle of the part above the horizon.
    double solid_angle() const { return total_; }
    /// See CapSampler::meets().
    std::optional<double> meets(const Vec3d& direction) const;

  private:
    struct Piece {
        Vec3d a, b, c;
        double solid_angle;
        double area;                                 // 0 unless it is sampled by area
        std::optional<SphericalTriangle> spherical;  // set unless it is sampled by area
    };
    LightSample sample(const Piece& piece, const glm::dvec2& point) const;
    double weight(const Piece& piece, double distance) const;
    void start(const Vec3d& normal, const Vec3d& corner);
    void add_clipped(const Vec3d& a, const Vec3d& b, const Vec3d& c);

    std::vector<Piece> pieces_;
    double total_ = 0;
    Vec3d normal_{0};
    double height_ = 0;  // distance of the plane from the hit, along the normal
};

}  // namespace shlight
