// SPDX-License-Identifier: MIT
//
// A lat-long picture as light: looked up, blurred, sampled and expanded in harmonics.
//
// A sun would need thousands of bands. What of the picture's brightest texels exceeds a limit is taken out of what is
// expanded and blurred, and kept as a list of directions of no extent.
//
// Between the centres of texels radiance is bilinear in longitude and latitude; beyond the outermost rows' centres, at
// the poles, it is constant along a meridian. Everything here is of that function. Directions are unit vectors of the
// picture's own frame, z towards row 0.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "shlight/environment.h"
#include "shlight/types.h"

namespace shlight {

/// A direction's longitude and latitude in units of texels: texel (column, row) has its centre at (column + ½, row +
/// ½).
glm::dvec2 texel_of(const Vec3d& direction, int width, int height);
Vec3d direction_of(const glm::dvec2& texel, int width, int height);

/// Pictures of half the size each, down to one texel.
class RadiancePyramid {
  public:
    enum class Levels { all, first };
    RadiancePyramid(std::vector<Rgb> pixels, int width, int height, Levels wanted = Levels::all);

    /// Its rows follow each other from the pixel number `first` on.
    struct Level {
        int width, height, first;
    };

    Rgb radiance(const Vec3d& direction) const;
    int width() const { return levels_[0].width; }
    int height() const { return levels_[0].height; }
    /// The finest one first.
    std::span<const Level> levels() const { return levels_; }
    /// Of all levels.
    const Rgb* pixels() const { return pixels_.data(); }

  private:
    std::vector<Level> levels_;
    std::vector<Rgb> pixels_;
};

/// Directions as densely as the light's luminance, of cells between the centres of four texels.
class RadianceSampler {
  public:
    /// Precondition: a picture that is not black.
    RadianceSampler(std::span<const Rgb> pixels, int width, int height);

    Vec3d sample(const glm::dvec2& point) const;
    /// Per solid angle.
    double density(const Vec3d& direction) const;
    /// height + 1 rows: how densely one draws if all of its cells have the same share.
    const float* row_densities() const { return row_densities_.data(); }
    /// (height + 1) × width: the share of the cells of a row up to each one, it included.
    const float* cells() const { return cells_.data(); }

  private:
    std::size_t cell(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(column);
    }

    int width_, height_;        // of the picture: width_ cells in a row, height_ + 1 rows
    std::vector<double> rows_;  // share of all rows up to each one, it included
    std::vector<float> cells_;
    std::vector<double> latitudes_;  // cosθ where each row of cells begins, and the last one ends
    std::vector<float> row_densities_;
};

/// A bright texel's light beyond the limit.
struct BrightSpot {
    Vec3d direction;
    Rgb irradiance;  ///< on a plane that faces it
};

/// A picture without the spots that were taken out of it.
struct SplitPicture {
    std::vector<Rgb> pixels;
    std::vector<BrightSpot> spots;
};

SplitPicture without_spots(std::span<const Rgb> pixels, int width, int height);

/// Bands 0 … 63 in three colour channels.
struct RadianceCoefficients {
    std::array<std::vector<float>, 3> channels;
    /// Σ_m of the squares, of the channel that has most.
    std::array<double, kMaxOrder> powers;
};

RadianceCoefficients radiance_coefficients(std::span<const Rgb> pixels, int width, int height);

/// What the expansion leaves of a picture, at the centres of its texels.
std::vector<Rgb> remainder_of(std::span<const Rgb> pixels, int width, int height,
                              const RadianceCoefficients& coefficients);

/// All of it.
struct EnvironmentMap {
    explicit EnvironmentMap(const LatLong& source);

    Vec3d to_map(const Vec3d& world) const { return world * to_world; }

    glm::dmat3 to_world;      // a rotation
    double texel;             // the angle between two rows
    RadiancePyramid picture;  // one level
    RadianceSampler sampler;
    std::vector<BrightSpot> spots;
    RadiancePyramid smooth;             // the picture without the spots, one level
    RadianceCoefficients coefficients;  // likewise
    RadiancePyramid remainder;          // what the coefficients leave, without the spots
    RadiancePyramid whole_remainder;    // and with them

  private:
    EnvironmentMap(const LatLong& source, SplitPicture split);
};

}  // namespace shlight
