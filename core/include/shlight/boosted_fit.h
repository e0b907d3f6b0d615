// SPDX-License-Identifier: MIT
//
// Fits of lobes in a boosted frame. There a lobe of any width is broad, and few bands describe it; a lobe without a
// peak has no boost.
//
// g(u) = f·cos(ω(u)) dω/du is fitted over the boosted upper hemisphere u_z ≥ z_0 by least squares in u: a light's
// radiance is the integral over a part of that region, so this norm bounds a picture's error. docs/theory.md, 6, shows
// how many bands are needed. The view direction is ω_o = (sinθ_o, 0, cosθ_o): there are only cosine terms.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "shlight/boost.h"
#include "shlight/lobe_shape.h"
#include "shlight/types.h"

namespace shlight {

/// Smallest cosθ_o with a fit.
inline constexpr double kLeastFittedCosine = 0.02;

/// The boost that makes a lobe broad: along the mirror direction, and a smooth closed form, so that coefficients
/// tabulated over roughness and view angle can be interpolated. The identity for a shape without a peak.
Boost lobe_boost(const LobeShape& shape, double cos_theta_o);

/// The fits of one shape at all view angles. Views below kLeastFittedCosine get the fit at that cosine.
class BoostedFit {
  public:
    /// order: the only one, 1 … 64, or 0 for all that a hit may choose from. Lambert has no terms beyond order 2, which
    /// stands for all higher orders. Precondition: neither a mirror nor anisotropic.
    explicit BoostedFit(const LobeShape& shape, int order = 0);

    const LobeShape& shape() const { return shape_; }
    std::vector<int> orders() const;
    /// ∫ f·cos dω over the upper hemisphere.
    double albedo(double cos_theta_o) const;
    /// Writes the cosine_count(order) cosine terms for one view angle; order: one of orders().
    void coefficients(double cos_theta_o, int order, float* cosine_terms) const;
    /// The table for looking up many views; null for Lambert, which has a closed form.
    const class FitTable* table() const { return table_.get(); }

  private:
    LobeShape shape_;
    std::shared_ptr<const FitTable> table_;
    int order_;  // used for Lambert only
};

/// The fit of a shape, shared by all callers; the most recent ones are kept. Thread-safe.
std::shared_ptr<const BoostedFit> boosted_fit(const LobeShape& shape, int order = 0);

}  // namespace shlight
