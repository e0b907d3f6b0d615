// SPDX-License-Identifier: MIT
//
// A rule for integrals over a light that does not shine evenly, along the circles about the axis of its emission
// profile: on each of them the profile is one number, and where it has a kink, at the rim of a cone or of a spread, or
// where a circle begins to meet another side of the light, one piece of the rule ends and the next one begins. Between,
// all is smooth, so that few nodes do.
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

#include "lights/seen_light.h"
#include "math/gauss_legendre.h"
#include "shlight/disk.h"
#include "shlight/types.h"

namespace shlight {

/// Keeps its memory from light to light; one per thread.
class ProfileRings {
  public:
    /// False, and nothing is to be asked, for lights that this rule does not know: whose axis is none in the world
    /// (stretched cones), that are tiny, or neither caps, convex polygons nor disks.
    /// Of a rectangle or disk under a spread, the part that shines on the hit.
    bool reset(const SeenLight& seen);

    /// Pieces of the rule end on both sides of a unit direction of the shading frame at so many radians, and at
    /// multiples that grow geometrically: for a lobe that is narrower than the light. Until the next reset().
    void focus(const Vec3d& direction, double width);

    /// visit(direction, weight, factor): unit directions in the shading frame above the horizon; Σ weight ·
    /// g(direction) is the integral of g over the light. factor: factor_of(direction), asked once for each circle.
    /// `points` along each piece of a circle and across each piece between kinks.
    template <class Factor, class Visit>
    void for_nodes(int points, const Factor& factor_of, const Visit& visit);

  private:
    /// ω · normal ≥ offset, in the frame of the rings, whose z is their axis.
    struct Side {
        Vec3d normal;
        double offset;
        double across, azimuth;  // of the normal: its distance from the axis, and where it points
    };
    /// A disk in a plane at right angles to the axis.
    struct Disk {
        double height;  // of its plane above the hit
        glm::dvec2 center, u, v;
        double radius;                   // of a circle; 0: it is none
        std::vector<double> turns;       // t of c + u cos t + v sin t where it is nearest and farthest to the axis
        std::vector<double> near_turns;  // where it nearly is: the crossings' azimuths move fast there

        glm::dvec2 at(double t) const { return center + u * std::cos(t) + v * std::sin(t); }
        bool holds(const glm::dvec2& point) const;
        void find_turns();
        /// Azimuths at which the outline crosses the circle about the axis.
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
    void add_disk(const Ellipse<double>& ellipse);
    bool holds(const Vec3d& direction) const;
    void find_events(std::span<const double> kinks);
    void add_between(std::span<const double> angles);
    void add_event(const Vec3d& direction);
    void add_touching(const Side& side);
    void add_crossings(const Side& a, const Side& b);
    void add_disk_events();
    /// What of the circle at this angle to the axis lies on the light.
    void find_arcs(double cosine, double sine);
    void add_cuts(double cosine, double sine);
    void split_arcs(double sine);

    glm::dmat3 to_shading_{1};
    std::vector<Side> sides_;
    std::size_t corner_sides_ = 0;  // of these, the first ones are a polygon's
    std::optional<Disk> disk_;
    std::vector<double> events_;  // angles to the axis, rising
    std::vector<double> cuts_;    // azimuths at which the circle of find_arcs crosses the light's outline
    std::vector<Arc> arcs_, whole_arcs_;
    double focus_azimuth_ = 0, focus_width_ = 0;  // 0: none
};

template <class Factor, class Visit>
void ProfileRings::for_nodes(int points, const Factor& factor_of, const Visit& visit) {
    const GaussRule& rule = gauss_rule(points);
    for (std::size_t piece = 0; piece + 1 < events_.size(); ++piece) {
        const double width = events_[piece + 1] - events_[piece];
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            // Arcs begin and end like roots; the substitution makes that smooth.
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
