// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <optional>

#include "math/light_sample.h"
#include "regions/spherical_ellipse.h"

namespace shlight {

/// Samples directions to a disk. On each meridian about the cone's axis they are uniform in the part above the horizon.
/// Meridians are drawn as for an ellipse with the cone's half angles in Lambert's equal-area projection, so that the
/// density is constant for round and for narrow cones, and nearly constant for others.
class EllipseSampler {
  public:
    /// disk: in the shading frame.
    explicit EllipseSampler(const Ellipse& disk);
    /// If nothing lies above the horizon, a sample with weight and distance 0.
    LightSample sample(const glm::dvec2& point) const;
    /// Patches between meridians, see PolygonSampler::patch_count().
    static constexpr std::size_t kPatches = 4;
    LightSample sample_patch(std::size_t patch, const glm::dvec2& point) const {
        LightSample drawn = sample({point.x, (static_cast<double>(patch) + point.y) / kPatches});
        drawn.weight /= kPatches;
        return drawn;
    }
    /// Solid angle of the part above the horizon; within about 1 % if the horizon cuts.
    double solid_angle() const;
    /// See CapSampler::meets().
    std::optional<double> meets(const Vec3d& direction) const;

  private:
    /// Sine and cosine of an angle.
    struct Turn {
        explicit Turn(double angle) : sine(std::sin(angle)), cosine(std::cos(angle)) {}
        Turn(double s, double c) : sine(s), cosine(c) {}
        /// Sine and cosine of the sum of two angles.
        Turn then(const Turn& other) const {
            return {sine * other.cosine + cosine * other.sine, cosine * other.cosine - sine * other.sine};
        }

        double sine, cosine;
    };
    /// The light on one meridian.
    struct Meridian {
        Vec3d across;     ///< unit, at right angles to the axis
        double from, to;  ///< range of 1 - cos of the angle to the axis
        double weight;    ///< solid angle per unit of the parameter
    };
    Meridian meridian(const Turn& parameter) const;
    double distance(const Vec3d& direction) const { return height_ / glm::dot(normal_, direction); }

    SphericalEllipse ellipse_;
    Vec3d normal_;
    double height_;
    double long_ = 0, short_ = 0;     // half axes in the equal-area plane
    double middle_ = 0, widest_ = 0;  // centre and half width of the meridians' parameters
    double cot_square_long_ = 0, cot_square_short_ = 0;
};

}  // namespace shlight
