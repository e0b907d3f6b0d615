// SPDX-License-Identifier: MIT
//
// Methods applied to many lights, with the checks and errors of the library's batch functions.
#pragma once

#include <cstddef>
#include <span>

#include "method.h"
#include "shlight/bsdf.h"

namespace shlight::methods {

/// shlight::sphere_coefficients by a method. first: number of the first light in a longer batch, which selects its
/// random numbers. Throws also for an order above the method's largest and for lights that it does not support.
template <class T>
void sphere_coefficients(const Method& method, std::span<const Vec3<T>> centers, std::span<const T> radii, int order,
                         bool clip, const Options& options, std::size_t first, std::span<T> coefficients);
template <class T>
void cap_coefficients(const Method& method, std::span<const Vec3<T>> axes, std::span<const T> half_angles, int order,
                      bool clip, const Options& options, std::size_t first, std::span<T> coefficients);
template <class T>
void polygon_coefficients(const Method& method, std::span<const Vec3<T>> vertices, int vertex_count, int order,
                          bool clip, const Options& options, std::size_t first, std::span<T> coefficients);

/// shlight::shade_spheres and shade_polygons by a method. effort: evaluations of f·cos, or the order. Rejects mirrors.
void shade_spheres(const ShadingMethod& method, std::span<const Vec3d> centers, std::span<const double> radii,
                   const Bsdf& bsdf, std::span<const double> cos_theta_o, const Options& options, std::size_t first,
                   std::span<Rgb> radiance, std::span<std::int32_t> effort);
void shade_polygons(const ShadingMethod& method, std::span<const Vec3d> vertices, int vertex_count, const Bsdf& bsdf,
                    std::span<const double> cos_theta_o, const Options& options, std::size_t first,
                    std::span<Rgb> radiance, std::span<std::int32_t> effort);

}  // namespace shlight::methods
