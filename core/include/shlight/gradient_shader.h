// SPDX-License-Identifier: MIT
//
// Derivatives of what a material reflects of area lights, without shadows, by what moves the lights, and by roughness.
//
// By Leibniz's rule the integral of f·cos over a light changes by that of f·cos times the outline's normal velocity
// along the outline. f·cos itself is integrated there, to about 1e-8 of the derivative, so that the derivatives are
// those of the reflected radiance and not of the approximation within a tolerance that LightShader takes;
// docs/theory.md, 9.
#pragma once

#include <span>
#include <utility>

#include "shlight/bsdf.h"
#include "shlight/types.h"

namespace shlight {

/// Lights and views are those of LightShader. T: float or double, of what goes in and of the derivatives, which are
/// computed in double. Each derivative has three numbers, RGB, of unit radiance, before those of what it is taken by.
///
/// Mirrors show a light or not: their derivatives are 0, as are those of hidden lights and of polygons without area or
/// seen edge-on. A derivative beyond the range of T is the largest number of T. by_roughness moves the roughness of all
/// GGX lobes of the material together, and leaves the lobes' weights, as of layers, alone; other lobes have none.
/// Precondition: no lobes of two widths (has_two_widths()).
class GradientShader {
  public:
    explicit GradientShader(Bsdf bsdf) : bsdf_(std::move(bsdf)) {}

    /// by_center: count × 3 × 3 numbers, RGB by x, y, z; by_radius, by_roughness: count × 3, or empty. A sphere that
    /// touches the shading point has an infinite derivative by its half angle, which counts as 0.
    /// Throws as LightShader::spheres.
    template <class T>
    void spheres(std::span<const Vec3<T>> centers, std::span<const T> radii, std::span<const double> cos_theta_o,
                 std::span<T> by_center, std::span<T> by_radius, std::span<T> by_roughness,
                 std::span<const double> azimuth = {}) const;

    /// by_vertices: count × 3 × vertex_count × 3; by_roughness: count × 3, or empty. Throws as LightShader::polygons.
    template <class T>
    void polygons(std::span<const Vec3<T>> vertices, int vertex_count, std::span<const double> cos_theta_o,
                  std::span<T> by_vertices, std::span<T> by_roughness, std::span<const double> azimuth = {}) const;

  private:
    Bsdf bsdf_;
};

}  // namespace shlight
