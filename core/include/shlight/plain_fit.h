// SPDX-License-Identifier: MIT
//
// A lobe as plain spherical harmonics, without a warp, for those who want coefficients: the least-squares fit of f·cos
// over the *upper hemisphere*.
//
// Light coefficients are clipped at the horizon exactly, so below it the expansion may be anything; fitting only what
// counts spares the ringing of a projection over the whole sphere. docs/theory.md, 7.1, derives the fit.
// The view direction lies in the xz-plane, ω_o = (sinθ_o, 0, cosθ_o): only cosine terms (m ≥ 0) are non-zero.
#pragma once

#include <memory>
#include <vector>

#include "shlight/lobe_shape.h"
#include "shlight/types.h"

namespace shlight {

/// The fits of one shape, of all orders and views.
class PlainFit {
  public:
    /// Precondition: not a mirror.
    explicit PlainFit(const LobeShape& shape);

    /// √∫ (f·cos)² dω over the upper hemisphere.
    double norm(double cos_theta_o) const;
    /// L2 error of the fit over the upper hemisphere ÷ norm.
    double residual(double cos_theta_o, int order) const;
    /// Writes the cosine_count(order) cosine terms for one view angle.
    void coefficients(double cos_theta_o, int order, float* cosine_terms) const;

  private:
    double residual_at(std::size_t node, int order) const;

    // One row for each tabulated view; empty for Lambert, which is known in closed form.
    std::vector<double> reduced_;  // NormalEquations::reduce of the moments
    std::vector<double> norms_;
};

/// The fit of a shape, shared by everyone who asks for the same one; the last ones asked for are kept. Thread-safe.
std::shared_ptr<const PlainFit> plain_fit(const LobeShape& shape);

}  // namespace shlight
