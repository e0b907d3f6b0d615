// SPDX-License-Identifier: MIT
//
// What many lobes receive from many caps: light coefficients and their product with a lobe's in one pass.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "shlight/types.h"
#include "simd/lobe_arrays.h"

namespace shlight {

/// Circles in the shading frame, before any warp: Circle's members, an array for each.
struct CircleArrays {
    const double *x, *y, *z;
    const double *cosine, *sine;
};

/// The same, to be filled in.
struct CircleOutput {
    double *x, *y, *z;
    double *cosine, *sine;
};

/// Spheres in the shading frame.
struct SphereArrays {
    const Vec3<float>* centers;
    const float* radii;
};

/// circle_of_sphere of many spheres; precondition 0 < radius ≤ |center|, all finite.
void circles_of_spheres(std::span<const Vec3<float>> centers, const float* radii, const CircleOutput& circles);
void circles_of_spheres(std::span<const Vec3<double>> centers, const double* radii, const CircleOutput& circles);

/// values[i] = Σ f_lm L_lm of the cap inside circle circle_of[i] for the lobe at view view_of[i], clipped by the
/// horizon and seen through the view's warp. Lights that need the same are put together: hidden, crossing, and others.
void shade_caps(const CircleArrays& circles, std::span<const std::uint32_t> circle_of, const LobeArrays& lobe,
                std::span<const std::uint32_t> view_of, std::span<float> values);

/// The same for sphere i, whose circle no one else needs, at view view_of[i].
void shade_caps(const SphereArrays& spheres, const LobeArrays& lobe, std::span<const std::uint32_t> view_of,
                std::span<float> values);

}  // namespace shlight
