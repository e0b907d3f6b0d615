// SPDX-License-Identifier: MIT
//
// A quadrature rule for a light with an emission profile, along circles about the profile's axis. The profile is
// constant on each circle. A piece of the rule ends where the profile has a kink, at the rim of a cone or of a spread,
// and where circles begin or cease to cross a side of the light. Between these angles all integrands are smooth, so
// that few nodes suffice.
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

#include "lights/local_light.h"
#include "math/gauss_legendre.h"
#include "shlight/disk.h"
#include "shlight/types.h"

namespace shlight {

/// Memory is reused from light to light; one per thread.
class ProfileRings {
  public:
    /// False, and no other function may be called, for lights that this rule does not support: stretched cones, whose
    /// axis is not an axis in world space, tiny lights, and lights that are neither caps, convex polygons nor disks. A
    /// rectangle or disk with a spread is reduced to the part that shines on the hit.
    bool reset(const LocalLight& seen);

    /// Adds ends of pieces on both sides of a unit direction of the shading frame, at multiples of `width` [rad]: for a
    /// lobe that is narrower than the light. Valid until the next reset().
    void focus(const Vec3d& direction, double width);

    /// visit(direction, weight, factor) with unit directions in the shading frame above the horizon; Σ weight ·
    /// g(direction) is the integral of g over the light. factor: factor_of(direction), called once for each circle.
    /// points: along each arc of a circle, and across each piece between kinks.
    template <class Factor, class Visit>
    void for_nodes(int points, const Factor& factor_of, const Visit& visit);

  private:
    /// The half space ω · normal ≥ offset, in the frame of the rings, whose z is the profile's axis.
    struct Side {
        Vec3d normal;
        double offset;
        double across, azimuth;  // of the normal: sine of its angle to the axis, and azimuth
    };
    /// A disk in a plane perpendicular to the axis.
    struct Disk {
        double height;  // distance of the plane from the hit
        glm::dvec2 center, u, v;
        double radius;                   // of a circle; 0: the disk is an ellipse
        std::vector<double> turns;       // t of c + u cos t + v sin t at extremal distances to the axis
        std::vector<double> near_turns;  // t of near extrema, where azimuths of crossings change fast

        glm::dvec2 at(double t) const { return center + u * std::cos(t) + v * std::sin(t); }
        bool holds(const glm::dvec2& point) const;
        void find_turns();
        /// Adds the azimuths at which the disk's edge crosses a circle about the axis, given by its radius in the
        /// plane.
        void add_cuts(double circle, std::vector<double>& cuts) const;
    };
    struct Arc {
        double begin, length;  // azimuths
    };

    Vec3d to_rings(const Vec3d& direction) const { return direction * to_shading_; }
    void add_side(const Vec3d& normal, double offset);
    void add_horizon() { add_side(to_rings({0, 0, 1}), 0); }
    bool add_cap(const CapView& cap);
    bool add_polygon(std::span<const Vec3d> corners);
    void add_disk(const Ellipse& ellipse);
    bool holds(const Vec3d& direction) const;
    void find_events(std::span<const double> kinks);
    void add_between(std::span<const double> angles);
    void add_event(const Vec3d& direction);
    void add_touching(const Side& side);
    void add_crossings(const Side& a, const Side& b);
    void add_disk_events();
    /// The arcs on the light of the circle at this angle to the axis.
    void find_arcs(double cosine, double sine);
    void add_cuts(double cosine, double sine);
    void split_arcs(double sine);

    glm::dmat3 to_shading_{1};
    std::vector<Side> sides_;
    std::size_t corner_sides_ = 0;  // number of sides, from the first on, that belong to a polygon
    std::optional<Disk> disk_;
    std::vector<double> events_;  // angles to the axis, rising
    std::vector<double> cuts_;    // azimuths at which the circle of find_arcs() crosses the light's edge
    std::vector<Arc> arcs_, whole_arcs_;
    double focus_azimuth_ = 0, focus_width_ = 0;  // width 0: no focus
};

template <class Factor, class Visit>
void ProfileRings::for_nodes(int points, const Factor& factor_of, const Visit& visit) {
    const GaussRule& rule = gauss_rule(points);
    for (std::size_t piece = 0; piece + 1 < events_.size(); ++piece) {
        const double width = events_[piece + 1] - events_[piece];
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            // Arc lengths start and end like square roots; the substitution 3s² - 2s³ makes that smooth.
            const double s = rule.nodes[i];
            const double angle = events_[piece] + width * s * s * (3 - 2 * s);
            const double cosine = std::cos(angle);
            const double sine = std::sin(angle);
            const double ring = rule.weights[i] * 6 * s * (1 - s) * width * sine;
            const double factor = factor_of(to_shading_ * Vec3d(sine, 0, cosine));
            find_arcs(cosine, sine);
            for (const Arc& arc : arcs_) {
                for (std::size_t j = 0; j < rule.nodes.size(); ++j) {
                    const double azimuth = arc.begin + arc.length * rule.nodes[j];
                    const Vec3d direction(sine * std::cos(azimuth), sine * std::sin(azimuth), cosine);
                    visit(to_shading_ * direction, ring * arc.length * rule.weights[j], factor);
                }
            }
        }
    }
}

}  // namespace shlight
