// SPDX-License-Identifier: MIT
//
// A lobe as plain spherical harmonics, without a warp, for those who want coefficients: the least-squares fit of f·cos
// over the *upper hemisphere*.
//
// Light coefficients are clipped at the horizon exactly, so below it the expansion may be anything; fitting only what
// counts spares the ringing of a projection over the whole sphere. docs/algorithms.md derives the fit.
// The view direction lies in the xz-plane, ω_o = (sinθ_o, 0, cosθ_o): only cosine terms (m ≥ 0) are non-zero.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "shlight/lobe_shape.h"
#include "shlight/types.h"

namespace shlight {

/// Orders whose tables are kept: those that are asked for again.
inline constexpr std::array<int, 12> kOrderLadder = {1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64};

/// The coefficients of one order, tabulated over the view angle and interpolated.
class LobeTable {
  public:
    /// nodes: one row of cosine_count(order) values for each view angle θ_o, equally spaced over 0 … π/2;
    /// a single row for a lobe that does not depend on the view.
    LobeTable(int order, std::vector<float> nodes);

    int order() const { return order_; }
    /// Writes the cosine_count(order()) cosine terms for one view angle.
    void coefficients(float cos_theta_o, float* cosine_terms) const;

  private:
    int order_;
    std::vector<float> nodes_;
};

/// All fits of one shape.
class LobeFit {
  public:
    explicit LobeFit(const LobeShape& shape);

    const LobeShape& shape() const { return shape_; }
    /// ∫ f·cos dω over the upper hemisphere.
    double albedo(double cos_theta_o) const;
    /// √∫ (f·cos)² dω over the upper hemisphere.
    double norm(double cos_theta_o) const;
    /// L2 error of the fit over the upper hemisphere ÷ norm, for any order 1 … 64.
    double residual(double cos_theta_o, int order) const;
    /// The table of one order: kept for those of the ladder, solved for the others.
    std::shared_ptr<const LobeTable> table(int order) const;

  private:
    void fit_all_views();
    LobeTable solve_table(int order) const;

    LobeShape shape_;
    // One row per view angle; empty for Lambert, which does not depend on it and is known in closed form.
    std::vector<double> reduced_;  // moments ∫ f·cos · (basis) dω, reduced so that they serve every order
    std::vector<double> norms_;
    std::vector<double> albedos_;
    std::vector<float> residuals_;  // × 64 orders
    std::array<std::shared_ptr<const LobeTable>, kOrderLadder.size()> ladder_;
};

/// The fit of a shape, shared by everyone who asks for the same one while anyone keeps it, and for some time after.
/// Thread-safe.
std::shared_ptr<const LobeFit> fitted(const LobeShape& shape);

}  // namespace shlight
