// SPDX-License-Identifier: MIT
//
// Coefficients of sphere lights with their exact derivatives by centre and radius.
//
// A turn about an axis, and a boost along one, take caps to caps. Of the coefficients they make sums of those of the
// same band, and of the bands beside it, less what crosses the horizon, which is a Fourier series; docs/theory.md, 9,
// derives both.
#pragma once

#include <span>

#include "shlight/types.h"

namespace shlight {

/// Largest order with derivatives: those of the last band take one band more.
inline constexpr int kMaxGradientOrder = kMaxOrder - 1;

/// Makes the coefficients of sphere_coefficients and their derivatives [1/length]. coefficients and by_radius:
/// centers.size() × order², by_center: centers.size() × order² × 3. The derivatives of a hidden sphere are 0, and so
/// are those by the half angle of a sphere that touches the shading point, whose limit is infinite. Throws as
/// sphere_coefficients does, and for order > kMaxGradientOrder.
template <class T>
void sphere_coefficients_gradient(std::span<const Vec3<T>> centers, std::span<const T> radii, int order, bool clip,
                                  std::span<T> coefficients, std::span<T> by_center, std::span<T> by_radius);

}  // namespace shlight
