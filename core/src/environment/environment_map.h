// SPDX-License-Identifier: MIT
//
// A lat-long picture as light: looked up, blurred, sampled and expanded in harmonics.
//
// A sun would need thousands of bands. The light of the picture's brightest texels beyond a limit, their spots, is
// taken out of what is expanded and blurred, and kept as a list of directions of no extent.
//
// An 8k picture has 34 million texels of 12 bytes. Beside it this keeps 12 bytes a texel: the sampler's 4, and two
// pyramids without their finest level at 4 each.
//
// Between the centres of texels radiance is bilinear in longitude and latitude; beyond the outermost rows' centres, at
// the poles, it is constant along a meridian. Everything here is of that function. Directions are unit vectors of the
// picture's own frame, z towards row 0.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <numbers>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "shlight/environment.h"
#include "shlight/parallel.h"
#include "shlight/types.h"

namespace shlight {

/// Weights of linear Rec. 709 RGB in luminance, which are rounded there to four digits: the row of Y in the matrix from
/// primaries with a white point of D65 to CIE XYZ, as Cycles has it.
inline constexpr Vec3d kLuminance(0.2126729, 0.7151522, 0.0721750);

/// A direction's longitude and latitude in units of texels: texel (column, row) has its centre at (column + ½, row +
/// ½).
glm::dvec2 texel_of(const Vec3d& direction, int width, int height);
Vec3d direction_of(const glm::dvec2& texel, int width, int height);

/// direction: of the picture's frame.
Rgb radiance_from(const LatLong& picture, const Vec3d& direction);

/// Pictures of half the size each, from one of half the size down to one texel.
class RadiancePyramid {
  public:
    /// The rows of the picture that the pyramid stands on, which it does not keep.
    using Row = std::function<void(int row, std::span<Rgb> texels)>;
    /// Precondition: of more than one texel. Throws RenderCancelled once it is to end.
    RadiancePyramid(int width, int height, const Row& finest, const Stopped& stopped);

    /// Its rows follow each other from the pixel number `first` on.
    struct Level {
        int width, height, first;
    };

    /// The finest one first.
    std::span<const Level> levels() const { return levels_; }
    /// All levels' pixels.
    const Rgb* pixels() const { return pixels_.data(); }

  private:
    std::vector<Level> levels_;
    std::vector<Rgb> pixels_;
};

/// Directions as densely as the light's luminance, of cells between the centres of four texels.
class RadianceSampler {
  public:
    /// Precondition: a picture that is not black. Throws RenderCancelled once it is to end.
    explicit RadianceSampler(const LatLong& picture, const Stopped& stopped = {});

    int width() const { return width_; }
    int height() const { return height_; }
    /// Column and row of a direction's cell.
    glm::ivec2 cell_of(const Vec3d& direction) const;
    Vec3d sample(const glm::dvec2& point) const;
    /// Per solid angle.
    double density(const Vec3d& direction) const;
    /// height + 1 rows: how densely one draws if all of its cells have the same share.
    const float* row_densities() const { return row_densities_.data(); }
    /// The share of all rows up to each one, it included.
    const double* rows() const { return rows_.data(); }
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

/// The light of a picture beyond a limit of luminance.
struct BrightTexels {
    double limit;
    std::vector<BrightSpot> spots;

    explicit BrightTexels(const LatLong& picture);

    /// A texel's radiance, scaled down to the limit if it exceeds that.
    Rgb below(const Rgb& texel) const;
};

/// Bands 0 … 63 in three colour channels.
struct RadianceCoefficients {
    std::array<std::vector<float>, 3> channels;
    /// Σ_m of the squares, of the channel that has most.
    std::array<double, kMaxOrder> powers;
};

/// Coefficients of a picture without its spots. Throws RenderCancelled once it is to end.
RadianceCoefficients radiance_coefficients(const LatLong& picture, const BrightTexels& bright,
                                           const Stopped& stopped = {});

/// The data for lighting by a picture.
struct EnvironmentMap {
    /// Throws RenderCancelled once it is to end.
    explicit EnvironmentMap(std::shared_ptr<const LatLong> source, const Stopped& stopped = {});

    Vec3d to_map(const Vec3d& world) const { return world * picture->to_world; }
    /// The angle between two rows.
    double texel() const { return std::numbers::pi / picture->height; }

    std::shared_ptr<const LatLong> picture;
    BrightTexels bright;
    RadianceSampler sampler;
    RadianceCoefficients coefficients;  ///< without the spots
    RadiancePyramid smooth;             ///< of the picture without the spots
    RadiancePyramid whole;              ///< of the picture with them
};

}  // namespace shlight
