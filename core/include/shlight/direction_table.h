// SPDX-License-Identifier: MIT
//
// A number for each direction of a frame, as luminaires are measured.
#pragma once

#include <cstddef>
#include <vector>

#include "shlight/types.h"

namespace shlight {

struct ProfileRange {
    double low, high;
};

/// In equal steps of latitude and longitude, bilinear between the centres of its texels. Row 0 lies around +z; columns
/// go from -x over +y, +x (the middle) and -y back to -x.
class DirectionTable {
  public:
    /// values: row by row, a multiple of `width` of them. Throws std::invalid_argument naming `profile`: no value, one
    /// that is negative or not finite, or none above 0.
    DirectionTable(std::vector<float> values, std::size_t width);

    /// direction: of any length > 0.
    double at(const Vec3d& direction) const;
    /// Bounds over the cap of directions within half_angle [0, π] of a direction.
    ProfileRange range(const Vec3d& direction, double half_angle) const;
    /// An angle [rad], at most 1, within which of a direction the number changes by less than half the largest.
    double scale(const Vec3d& direction) const;

  private:
    struct Place {
        double row, column;  ///< in texels
    };
    Place place(const Vec3d& direction) const;
    double texel(std::ptrdiff_t row, std::ptrdiff_t column) const;

    std::vector<float> values_;
    std::size_t width_, height_;
    std::vector<ProfileRange> blocks_;  // of texels side by side
    std::size_t blocks_along_;
    ProfileRange all_;
};

}  // namespace shlight
