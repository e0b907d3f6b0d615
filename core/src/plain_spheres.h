// SPDX-License-Identifier: MIT
//
// Spheres under a material whose lobes are all integrated by harmonics of one order: nothing is chosen or sorted, and
// kernels take spheres and views as they come.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "aligned_floats.h"
#include "material_lobes.h"
#include "material_views.h"
#include "shlight/types.h"

namespace shlight {

/// Keeps its memory from call to call; one per thread.
class PlainSpheres {
  public:
    /// Whether a material is of this kind.
    static bool takes(const MaterialLobes& material);

    /// Precondition: takes(material); it is kept by reference.
    explicit PlainSpheres(const MaterialLobes& material);

    /// cos_theta_o: of each sphere, or one for all. radiance, effort: as LightShader. Precondition: check_sphere
    /// accepts all of them.
    void shade(std::span<const Vec3f> centers, const float* radii, std::span<const double> cos_theta_o,
               std::span<Rgb> radiance, std::span<std::int32_t> effort);

  private:
    void find_values(std::size_t lobe, std::span<const Vec3f> centers, const float* radii,
                     std::span<const double> cos_theta_o);
    /// Adds what one lobe reflects to the radiance, or sets it to that.
    void add(std::size_t lobe, std::span<const double> cos_theta_o, std::span<Rgb> radiance) const;

    const MaterialLobes& material_;
    std::vector<AlignedFloats> terms_;  // of the lobes that have no warp
    MaterialViews view_;                // the only one
    std::vector<float> values_;
};

}  // namespace shlight
