// SPDX-License-Identifier: MIT
//
// Random directions from the origin with their densities: towards a light, uniform in solid angle or over its surface,
// or as a lobe reflects.
//
// A sampler maps a point of the unit square to a direction. Samplers of lights ignore the horizon; callers treat
// directions below it as dark.
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "regions/spherical_polygon.h"
#include "shlight/cap.h"
#include "shlight/disk.h"
#include "shlight/types.h"

namespace shlight::methods {

struct RandomDirection {
    Vec3d direction;  ///< unit
    double density;   ///< per solid angle; 0: the direction does not count
};

/// Uniform in the cone of a cap, of any half angle.
class ConeSampler {
  public:
    explicit ConeSampler(const SphericalCap& cap);
    RandomDirection sample(const glm::dvec2& point) const;
    /// 0 outside.
    double density(const Vec3d& direction) const;

  private:
    SphericalCap cap_;
    Vec3d across_, up_;
    double height_;   // 1 - cosine of the half angle
    double density_;  // inside
};

/// Uniform over the whole surface of a sphere; points on its back do not count.
class SphereSurfaceSampler {
  public:
    /// circle: the sphere's contour.
    explicit SphereSurfaceSampler(const SphericalCap& circle) : circle_(circle) {}
    RandomDirection sample(const glm::dvec2& point) const;

  private:
    SphericalCap circle_;
};

/// Uniform over the disk, perpendicular to its axis, that covers a cap of half angle < π/2.
class DiskSampler {
  public:
    explicit DiskSampler(const SphericalCap& cap);
    RandomDirection sample(const glm::dvec2& point) const;

  private:
    SphericalCap cap_;
    Vec3d across_, up_;
};

/// Triangles, chosen in proportion to their solid angles or areas and sampled uniformly. Negative triangles in a
/// concave polygon's fan are sampled too; points outside of the polygon do not count.
class TriangleSampler {
  public:
    enum class Uniform { in_solid_angle, in_area };

    explicit TriangleSampler(Uniform uniform = Uniform::in_solid_angle) : uniform_(uniform) {}
    /// The triangles of a fan. Vertices of any length > 0, in one plane or, in solid angle, on one sphere.
    TriangleSampler(Uniform uniform, std::span<const Vec3d> polygon);

    /// Starts anew, reusing memory.
    void clear();
    /// Adds a triangle with corners of any length > 0; adjacent triangles have the same winding.
    void add(const Vec3d& first, const Vec3d& second, const Vec3d& third);
    /// Whether there is nothing to sample: no area, or edge-on.
    bool empty() const { return pieces_.empty(); }
    /// Precondition: not empty.
    RandomDirection sample(glm::dvec2 point) const;
    /// 0 outside.
    double density(const Vec3d& direction) const;

  private:
    struct Piece {
        Vec3d a, ab, ac;
        double volume;   // a · (ab × ac), signed
        double size;     // solid angle or area
        bool spherical;  // or flat

        bool contains(const Vec3d& direction) const;
        /// Density of a direction inside, times the size.
        double relative_density(const Vec3d& direction) const;
    };

    Uniform uniform_;
    std::vector<Piece> pieces_;
    double total_ = 0;
    int positive_ = 0, negative_ = 0;  // pieces by the sign of their volume
};

/// Uniform over the area of any ellipse; an ellipse seen edge-on has density 0.
class EllipseAreaSampler {
  public:
    explicit EllipseAreaSampler(const Ellipse& ellipse);
    RandomDirection sample(const glm::dvec2& point) const;
    /// 0 outside.
    double density(const Vec3d& direction) const;
    /// Distance to the ellipse's plane.
    double distance(const Vec3d& direction) const { return height_ / glm::dot(normal_, direction); }

  private:
    /// Density of a direction that meets the ellipse.
    double density_at(double distance) const { return distance * distance * distance / (area_ * std::abs(height_)); }

    Ellipse ellipse_;
    Vec3d normal_;
    double area_, height_;
};

}  // namespace shlight::methods
