// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <optional>

#include "disks/spherical_ellipse.h"
#include "math/light_sample.h"

namespace shlight {

/// Directions to a disk, about its cone's axis: along each meridian uniform in what the horizon leaves of it. Meridians
/// are drawn as those of an ellipse of the cone's half angles in Lambert's equal-area projection, which makes the
/// density even for round cones and narrow ones, and nearly so for others.
class EllipseSampler {
  public:
    /// In the shading frame.
    explicit EllipseSampler(const Ellipse<double>& disk);
    /// Where nothing lies above the horizon, a sample of no weight and no distance.
    LightSample sample(const glm::dvec2& point) const;
    /// As PolygonSampler's: parts between meridians.
    static constexpr std::size_t kPatches = 4;
    LightSample sample_patch(std::size_t patch, const glm::dvec2& point) const {
        LightSample drawn = sample({point.x, (static_cast<double>(patch) + point.y) / kPatches});
        drawn.weight /= kPatches;
        return drawn;
    }
    /// Above the horizon, to a part in a hundred or so where that cuts.
    double solid_angle() const;
    /// As CapSampler::meets.
    std::optional<double> meets(const Vec3d& direction) const;

  private:
    /// Sine and cosine of an angle.
    struct Turn {
        explicit Turn(double angle) : sine(std::sin(angle)), cosine(std::cos(angle)) {}
        Turn(double s, double c) : sine(s), cosine(c) {}
        /// Of the sum of two angles.
        Turn then(const Turn& other) const {
            return {sine * other.cosine + cosine * other.sine, cosine * other.cosine - sine * other.sine};
        }

        double sine, cosine;
    };
    /// What a meridian has of the light: 1 - cos of the angle to the axis, and solid angle per unit of the parameter.
    struct Meridian {
        Vec3d across;  ///< unit, at right angles to the axis
        double from, to;
        double weight;
    };
    Meridian meridian(const Turn& parameter) const;
    double distance(const Vec3d& direction) const { return height_ / glm::dot(normal_, direction); }

    SphericalEllipse<double> ellipse_;
    Vec3d normal_;
    double height_;
    double long_ = 0, short_ = 0;     // half axes in the equal-area plane
    double middle_ = 0, widest_ = 0;  // parameters of meridians
    double cot_square_long_ = 0, cot_square_short_ = 0;
};

}  // namespace shlight
