// SPDX-License-Identifier: MIT
//
// The directions of an environment in blocks: of equal azimuth and, as far as its rows of texels allow, of equal steps
// in cosθ.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "shlight/environment.h"
#include "shlight/types.h"

namespace shlight {

inline constexpr std::size_t kBlockColumns = 32;
inline constexpr std::size_t kBlockRows = 16;
inline constexpr std::size_t kBlocks = kBlockColumns * kBlockRows;

/// Immutable. Directions are of the world.
class SkyBlocks {
  public:
    /// Precondition: prepared and not black; it must outlive this.
    explicit SkyBlocks(const Environment& environment);

    /// The share of a block in the luminance from everywhere.
    float light(std::size_t block) const { return light_[block]; }
    std::size_t block_of(const Vec3d& direction) const;
    /// The direction within a block of some light that belongs to a point of the unit square, as densely as the
    /// environment draws directions itself.
    Vec3d sample(std::size_t block, double u, double v) const;

  private:
    void divide(const class RadianceSampler& sampler);

    const struct EnvironmentMap* map_;  // null: one radiance
    std::array<float, kBlocks> light_{};
    // Only a picture has these:
    std::vector<std::uint8_t> row_of_, column_of_;               // blocks of its rows and columns
    std::array<std::size_t, kBlockRows + 1> first_row_{};        // of each row of blocks
    std::array<std::size_t, kBlockColumns + 1> first_column_{};  // likewise
    /// by column of blocks: the light of its part of all rows up to each one, it included
    std::array<std::vector<double>, kBlockColumns> up_to_row_;
};

}  // namespace shlight
