// SPDX-License-Identifier: MIT
//
// Anisotropic lobes in spherical harmonics: integrals with all terms, cosines and sines, at views all around, and
// interpolation between these.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "lobes/normal_equations.h"
#include "math/gauss_legendre.h"
#include "shlight/lobe_shape.h"
#include "shlight/lobe_table.h"

namespace shlight {

/// One view's f·cos over the upper hemisphere.
struct FullMoments {
    std::vector<double> cosines, sines;  ///< ∫ f·cos Y_lm dω for m ≥ 0, and for -m; cosine_index layout
    double norm_squared = 0;             ///< ∫ (f·cos)² dω
    double albedo = 0;
};

/// Heights 0 … 1 that integrate harmonics of all orders exactly, and the harmonics there.
const GaussRule& upper_heights();
const HeightBasis& upper_basis();

/// The moments of the bands below an order > 1, in the frame of the surface's tangent, or of the view.
FullMoments full_moments(const TableShape& shape, double theta_o, bool of_tangent, int order);

/// Rows of a table and their weights in an interpolation.
struct RowTaps {
    std::array<std::size_t, 16> rows{};
    std::array<float, 16> weights{};
    std::size_t count = 0;

    /// Interpolates numbers from a column on.
    void interpolate(std::span<const float> table, std::size_t row_size, std::size_t column, std::size_t width,
                     float* out) const;
};

/// Views θ_o, φ_o of which one table of an anisotropic lobe has a row each.
class AnisotropicViews {
  public:
    explicit AnisotropicViews(const LobeTable& table);

    std::size_t size() const { return axes_[0].size() * axes_[1].size(); }
    /// Calls function(view) for all views, in parallel.
    void for_each(const std::function<void(std::size_t view)>& function) const;
    /// full_moments() in the frame in which they are interpolated.
    FullMoments moments(const TableShape& shape, std::size_t view, int order) const;
    RowTaps taps(double cos_theta_o, double azimuth) const;
    /// Whether that is the frame of the surface's tangent, where the coefficients of a table of directions are linear
    /// between its own views. Otherwise it is that of the view, where a peak stays in its place as the azimuth changes.
    bool are_of_tangent() const { return own_axes_; }

  private:
    bool own_axes_;  // those of the table's views
    std::vector<TableAxis> axes_;
};

}  // namespace shlight
