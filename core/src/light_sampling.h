// SPDX-License-Identifier: MIT
//
// Directions to a light from a hit, spread over what of it lies above the horizon.
//
// Samplers turn a point of the unit square into a direction and a weight: the mean of weight · g(direction) over evenly
// spread points is the integral of g over the solid angle of the light above the horizon. They also meet a light with a
// ray in a given direction.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "ellipse_sampling.h"
#include "light_sample.h"
#include "light_view.h"
#include "mesh_view.h"
#include "shlight/types.h"

namespace shlight {

/// Uniform in the solid angle of a cap; along each meridian that the horizon cuts, uniform in what is left of it.
class CapSampler {
  public:
    explicit CapSampler(const CapView& cap);
    LightSample sample(const glm::dvec2& point) const;
    /// Above the horizon.
    double solid_angle() const;
    /// To the light's surface along a unit direction above the horizon; nothing where it misses.
    std::optional<double> meets(const Vec3d& direction) const;

  private:
    double distance(const Vec3d& direction, double cosine) const;  // to the light's surface

    CapView cap_;
    double distance_;                    // of the centre
    Vec3d axis_, up_, across_;           // up: at right angles to the axis, towards the zenith
    double axis_height_ = 1, tilt_ = 0;  // the axis' elevation: sine and cosine
    double one_minus_cos_ = 1;           // of the half angle
    double sine_ = 1;                    // likewise
    bool cut_ = false;                   // by the horizon
    double widest_;                      // azimuth about the axis, from `up`, where the light ends
};

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

/// Uniform in solid angle over each triangle; triangles that are about equally far everywhere are sampled by area.
class PolygonSampler {
  public:
    /// Sets the light and the hit; keeps its memory from one to the next.
    void reset(const PolygonLight& light, const ShadingFrame& frame);
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
        bool contains(const Vec3d& direction) const;
        double solid_angle;
        double area;                                 // where it is sampled by area
        std::optional<SphericalTriangle> spherical;  // where it is not
    };
    LightSample sample(const Piece& piece, const glm::dvec2& point) const;
    void add_rectangle(const std::array<Vec3d, 4>& corners);
    void add_clipped(const Vec3d& a, const Vec3d& b, const Vec3d& c);

    std::vector<Piece> pieces_;
    double total_ = 0;
    Vec3d normal_{0};
    double height_ = 0;  // of the plane over the hit, along the normal
};

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

/// Any of them. Precondition: the light is seen, and not a source without extent.
class LightSampler {
    enum class Kind { cap, ellipse, polygon, mesh };

    /// What `ask` returns of the sampler in use.
    template <class Ask>
    auto with(const Ask& ask) const {
        switch (kind_) {
            case Kind::cap:
                return ask(*cap_);
            case Kind::ellipse:
                return ask(*ellipse_);
            case Kind::mesh:
                return ask(mesh_);
            case Kind::polygon:
                break;
        }
        return ask(polygon_);
    }

  public:
    /// Of a rectangle or disk, the part that shines on the hit: see lit_rectangle and lit_part.
    void reset(const Light& light, const ShadingFrame& frame);
    LightSample sample(const glm::dvec2& point) const {
        return with([&](const auto& sampler) { return sampler.sample(point); });
    }
    /// As PolygonSampler's; not of a mesh.
    std::size_t patch_count() const {
        return kind_ == Kind::polygon ? polygon_.patch_count() : kind_ == Kind::ellipse ? EllipseSampler::kPatches : 1;
    }
    LightSample sample_patch(std::size_t patch, const glm::dvec2& point) const {
        return kind_ == Kind::polygon   ? polygon_.sample_patch(patch, point)
               : kind_ == Kind::ellipse ? ellipse_->sample_patch(patch, point)
                                        : sample(point);
    }
    double solid_angle() const {
        return with([](const auto& sampler) { return sampler.solid_angle(); });
    }
    std::optional<double> meets(const Vec3d& direction) const {
        return with([&](const auto& sampler) { return sampler.meets(direction); });
    }

    int layers(const Vec3d& direction) const { return kind_ == Kind::mesh ? mesh_.layers(direction) : 1; }

  private:
    Kind kind_ = Kind::polygon;
    std::optional<CapSampler> cap_;
    std::optional<EllipseSampler> ellipse_;
    PolygonSampler polygon_;
    MeshSampler mesh_;
};

}  // namespace shlight
