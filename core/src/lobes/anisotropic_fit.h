// SPDX-License-Identifier: MIT
//
// Anisotropic lobes in spherical harmonics without a boost: all n² coefficients f_lm(θ_o, φ_o) of Eq. 5 of Zhou & Wei
// 2020, fitted over the upper hemisphere as those of plain_fit.h, and interpolated between views.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "lobes/anisotropic_views.h"
#include "shlight/lobe_shape.h"

namespace shlight {

/// The fits of one shape at views all around.
class AnisotropicFit {
  public:
    /// order: the only one, 1 … 64, or 0 for all that a hit may choose from.
    AnisotropicFit(const TableShape& shape, int order);

    std::span<const int> orders() const { return orders_; }
    /// Writes kHeadWidth numbers as those of a FitTable: the albedo and the shading error of each order.
    void head(double cos_theta_o, double azimuth, float* out) const;
    /// Writes order² coefficients in the frame of the view, ω_o = (sinθ_o, 0, cosθ_o); order: one of orders().
    void coefficients(double cos_theta_o, double azimuth, int order, float* out) const;

  private:
    void fit_view(const TableShape& shape, std::size_t view);

    std::vector<int> orders_;
    std::vector<std::size_t> first_;  // column of each order
    std::size_t row_size_ = 0;
    AnisotropicViews views_;
    std::vector<float> rows_;
};

/// The fit of a shape, whatever its azimuth, shared by all callers; the most recent ones are kept. Thread-safe.
std::shared_ptr<const AnisotropicFit> anisotropic_fit(const TableShape& shape, int order);

}  // namespace shlight
