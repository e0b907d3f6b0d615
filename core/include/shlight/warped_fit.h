// SPDX-License-Identifier: MIT
//
// How a lobe is shaded: (warp, horizon, coefficients). In the warped sphere a lobe of any width is broad, and few bands
// describe it; a lobe without a peak is the case without warp.
//
// g(u) = f·cos(ω(u)) dω/du is fitted over the warped upper hemisphere u_z ≥ z_0 by least squares in u: what a light
// receives is an integral over a part of that region, so this is the norm that bounds the error of a picture.
// docs/theory.md, 6, shows how few bands are left. The view direction is ω_o = (sinθ_o, 0, cosθ_o): only cosine terms.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "shlight/lobe_shape.h"
#include "shlight/types.h"
#include "shlight/warp.h"

namespace shlight {

/// Views more grazing than this have no fit of their own.
inline constexpr double kLeastFittedCosine = 0.02;

/// The warp under which the lobe is broad: along the mirror direction, in smooth closed form, so that coefficients
/// tabulated over roughness and view angle interpolate. The identity for a shape without a peak.
Warp lobe_warp(const LobeShape& shape, double cos_theta_o);

/// One shape at all view angles. Views below kLeastFittedCosine get the lobe there; order_for says that none meets.
class WarpedFit {
  public:
    /// order: the only one, 1 … 64, or 0 for all that a hit may choose from. Lambert has no terms beyond order 2, which
    /// stands for all higher ones. Precondition: not a mirror.
    explicit WarpedFit(const LobeShape& shape, int order = 0);

    const LobeShape& shape() const { return shape_; }
    std::vector<int> orders() const;
    /// ∫ f·cos dω over the upper hemisphere.
    double albedo(double cos_theta_o) const;
    /// The root mean square, over caps in all directions, of the error of a cap's radiance ÷ albedo, from above.
    double shading_error(double cos_theta_o, int order) const;
    /// The smallest order whose shading error ≤ tolerance; 0 if none is.
    int order_for(double cos_theta_o, double tolerance) const;
    Warp warp(double cos_theta_o) const;
    /// Writes the cosine_count(order) cosine terms for one view angle; order: one of orders().
    void coefficients(double cos_theta_o, int order, float* cosine_terms) const;
    /// Where many views are looked up at once; null for Lambert, which is known in closed form.
    const class FitTable* table() const { return table_.get(); }

  private:
    double number(double cos_theta_o, std::size_t column) const;

    LobeShape shape_;
    std::shared_ptr<const FitTable> table_;
    int order_;  // of Lambert
};

/// The fit of a shape, shared by everyone who asks for the same one; the last ones asked for are kept. Thread-safe.
std::shared_ptr<const WarpedFit> warped_fit(const LobeShape& shape, int order = 0);

/// Completes the table that all GGX lobes interpolate in, of which each lobe has what it needs built; returns its size
/// in bytes.
std::size_t prepare_ggx_table();

}  // namespace shlight
