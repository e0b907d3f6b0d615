// SPDX-License-Identifier: MIT
//
// A lobe at one view in harmonics of one order, for Eq. 5 of Zhou & Wei 2020 by the library's kernels.
#pragma once

#include "method.h"
#include "simd/lobe_arrays.h"

namespace shlight::methods {

class HarmonicLobe : public LobeIntegrator {
  public:
    Reflected radiance(const SphericalCap& cap, std::uint32_t seed) const override;
    Reflected radiance(const SeenPolygon& polygon, std::uint32_t seed) const override;
    void radiances(std::span<const SphericalCap> caps, std::span<const std::uint32_t> seeds,
                   std::span<Reflected> results) const override;

  protected:
    /// Arrays of one view, which point into this object.
    void set(const LobeArrays& lobe) { lobe_ = lobe; }
    const LobeArrays& lobe() const { return lobe_; }

  private:
    LobeArrays lobe_{};
};

}  // namespace shlight::methods
