// SPDX-License-Identifier: MIT
//
// Types that all other headers use: vectors, colours, orders and coefficient indices.
//
// Conventions (docs/conventions.md):
//   * Shading frame: right-handed, the shading point is the origin, z is the surface normal.
//   * Real, orthonormal spherical harmonics without Condon–Shortley phase.
//   * order n means the bands l = 0 … n-1, that is n² coefficients at index l² + l + m.
#pragma once

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace shlight {

template <class T>
using Vec3 = glm::vec<3, T, glm::defaultp>;
using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;

/// Linear colour or radiance [W m⁻² sr⁻¹], Rec. 709 primaries.
using Rgb = glm::vec<3, float, glm::defaultp>;

/// The highest order: bands 0 … 63.
inline constexpr int kMaxOrder = 64;

/// Default tolerance of shade_*, render() and the Blender add-on.
inline constexpr double kDefaultTolerance = 1e-3;

/// Number of coefficients of an order.
constexpr int coefficient_count(int order) {
    return order * order;
}

/// Index of band l, degree m (-l ≤ m ≤ l).
constexpr int coefficient_index(int l, int m) {
    return l * l + l + m;
}

/// Number of cosine terms (m ≥ 0) of an order; a light or lobe with the mirror plane y = 0 has no others.
constexpr int cosine_count(int order) {
    return order * (order + 1) / 2;
}

/// Index of band l, degree m ≥ 0 in a list of cosine terms.
constexpr int cosine_index(int l, int m) {
    return l * (l + 1) / 2 + m;
}

/// How rows of coefficients are written. streamed: bypasses the caches, which is faster if the output, with other data
/// written at the same time, is larger than they are.
enum class Output { cached, streamed };

/// Throws std::invalid_argument naming `order` unless 1 ≤ order ≤ kMaxOrder.
void check_order(int order);

}  // namespace shlight
