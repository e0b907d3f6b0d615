// SPDX-License-Identifier: MIT
//
// The grid of view angles in tables of unboosted harmonics, and interpolation on it.
#pragma once

#include <cstddef>
#include <span>

namespace shlight {

/// View angles θ_o = 0 … π/2 in equal steps, fine enough for band 63 by cubics.
inline constexpr int kViewNodes = 129;

double view_angle(int node);
/// The position of any view on the grid, in steps.
double view_position(double cos_theta_o);

/// The two nodes next to a view, for linear interpolation (1 - t) · low + t · (low + 1) of slowly varying numbers.
struct ViewInterval {
    std::size_t low;
    double t;

    explicit ViewInterval(double cos_theta_o);
};

/// Cubic interpolation of cosine terms between four nodes. Beyond θ_o = 0 the table continues by symmetry: mirroring
/// the view multiplies a term of degree m by (-1)^m.
/// rows: kCosineMax terms for each node, or one row for all views; writes cosine_count(order) terms.
template <class T>
void interpolate_terms(std::span<const T> rows, float cos_theta_o, int order, T* cosine_terms);
/// The same for numbers that mirroring the view does not change, one for each node.
float interpolate_even(std::span<const float> nodes, float cos_theta_o);

}  // namespace shlight
