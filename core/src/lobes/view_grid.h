// SPDX-License-Identifier: MIT
//
// The grid of view angles that tables of unwarped harmonics share, and interpolation on it.
#pragma once

#include <cstddef>
#include <span>

namespace shlight {

/// View angles θ_o = 0 … π/2 in equal steps, fine enough for band 63 by cubics.
inline constexpr int kViewNodes = 129;

double view_angle(int node);
/// The same as a number of steps, for any view.
double view_position(double cos_theta_o);

/// Two neighbouring nodes, for what varies slowly or only steers a choice: (1 - t) · low + t · (low + 1).
struct ViewInterval {
    std::size_t low;
    double t;

    explicit ViewInterval(double cos_theta_o);
};

/// Cubic interpolation of cosine terms between four nodes. Beyond θ_o = 0 the table goes on by symmetry: a term of
/// degree m is multiplied by (-1)^m when the view is mirrored.
/// rows: kCosineMax terms for each node, or for all views alike; writes cosine_count(order) of them.
template <class T>
void interpolate_terms(std::span<const T> rows, float cos_theta_o, int order, T* cosine_terms);
/// The same of numbers that do not change when the view is mirrored, one for each node.
float interpolate_even(std::span<const float> nodes, float cos_theta_o);

}  // namespace shlight
