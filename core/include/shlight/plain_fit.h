// SPDX-License-Identifier: MIT
//
// A lobe in spherical harmonics without a boost, for users who want coefficients (Eq. 3 of Zhou & Wei 2020): the
// least-squares fit of f·cos over the *upper hemisphere*.
//
// Light coefficients are clipped at the horizon exactly, so the expansion may have any values below it, and the ringing
// of a projection over the whole sphere is avoided. docs/theory.md, 7.1, derives the fit. The view direction is ω_o =
// (sinθ_o, 0, cosθ_o): only cosine terms (m ≥ 0) are non-zero.
#pragma once

#include <memory>
#include <vector>

#include "shlight/lobe_shape.h"
#include "shlight/types.h"

namespace shlight {

/// The fits of one shape, of all orders and views.
class PlainFit {
  public:
    /// Precondition: neither a mirror nor anisotropic.
    explicit PlainFit(const LobeShape& shape);

    /// √∫ (f·cos)² dω over the upper hemisphere.
    double norm(double cos_theta_o) const;
    /// L2 error of the fit over the upper hemisphere ÷ norm; of a table also what it lacks of a function.
    double residual(double cos_theta_o, int order) const;
    /// Writes the cosine_count(order) cosine terms for one view angle.
    void coefficients(double cos_theta_o, int order, float* cosine_terms) const;

  private:
    double residual_at(std::size_t node, int order) const;

    // One row for each tabulated view; empty for Lambert, which has a closed form.
    std::vector<double> reduced_;  // results of NormalEquations::reduce()
    std::vector<double> norms_;
    TableShape table_;  // null unless the shape is one
};

/// The fit of a shape, shared by all callers; the most recent ones are kept. Thread-safe.
std::shared_ptr<const PlainFit> plain_fit(const LobeShape& shape);

/// The fit of an anisotropic shape at one view, whose azimuth is the shape's.
struct PlainView {
    std::vector<float> coefficients;  ///< order², in the frame of the surface's tangent
    double norm, residual;            ///< as of PlainFit
};
PlainView plain_view(const TableShape& shape, double cos_theta_o, int order);

}  // namespace shlight
