// SPDX-License-Identifier: MIT
//
// Spheres under warped lobes, straight from centre and radius.
#pragma once

#include <cstddef>

#include "kernels/lobe_arrays.h"
#include "kernels/tabulated_lobe.h"
#include "shlight/types.h"

namespace shlight {

/// values[i] = Σ f_lm L_lm of sphere i for the lobe at the view cos_theta_o[i], clipped by the horizon and seen through
/// that view's warp. Precondition: 0 < radius ≤ |center|, all finite; 0 ≤ cos_theta_o ≤ 1.
void shade_spheres_at_views(const Vec3<float>* centers, const float* radii, const double* cos_theta_o,
                            std::size_t count, const TabulatedLobe& lobe, float* values);

/// The same for the lobe's first view.
void shade_spheres_at_view(const Vec3<float>* centers, const float* radii, std::size_t count, const LobeArrays& lobe,
                           float* values);

}  // namespace shlight
