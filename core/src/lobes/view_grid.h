// SPDX-License-Identifier: MIT
//
// The grid of view angles that tables share, and interpolation on it.
#pragma once

#include <array>
#include <cstddef>

namespace shlight {

/// View angles θ_o = 0 … π/2 in equal steps, fine enough for band 63 by cubics.
inline constexpr int kViewNodes = 129;

double view_angle(int node);

/// Cubic interpolation between four nodes. Beyond θ_o = 0 the table goes on by symmetry: a term of degree m is
/// multiplied by (-1)^m when the view is mirrored.
struct ViewStencil {
    std::array<std::size_t, 4> nodes;
    std::array<float, 4> even;  ///< weights of terms with even m
    std::array<float, 4> odd;   ///< weights of terms with odd m

    explicit ViewStencil(float cos_theta_o);
};

}  // namespace shlight
