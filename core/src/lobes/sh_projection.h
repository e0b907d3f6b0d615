// SPDX-License-Identifier: MIT
//
// f·cos projected onto harmonics of the whole sphere (Eq. 3 of the paper), 0 below the horizon. It is multiplied with
// expansions of light that are not clipped at the horizon. (The fits of plain_fit.h have arbitrary values there.)
#pragma once

#include <memory>
#include <vector>

#include "shlight/lobe_shape.h"

namespace shlight {

/// One shape at all view angles, ω_o = (sinθ_o, 0, cosθ_o), for which all sine terms vanish.
class ShProjection {
  public:
    /// Precondition: not a mirror.
    explicit ShProjection(const LobeShape& shape);

    /// Whether only terms of degree 0 exist and the view does not matter.
    bool is_zonal() const { return node_count() == 1; }
    /// Writes the cosine_count(order) cosine terms for one view angle.
    void coefficients(float cos_theta_o, int order, float* cosine_terms) const;

    /// Number of tabulated view angles: 1, or that of view_grid.h.
    std::size_t node_count() const { return powers_.size() / kMaxOrder; }
    /// Σ_m f_lm² of the bands l = 0 … 63 at a node.
    const float* powers(std::size_t node) const { return &powers_[node * kMaxOrder]; }
    /// Σ f_lm² of all bands from 64 on.
    float tail(std::size_t node) const { return tails_[node]; }

  private:
    void add_node(const double* cosine_terms, double norm_squared);

    std::vector<float> terms_;  // nodes × kCosineMax
    std::vector<float> powers_, tails_;
};

/// The projection of a shape, shared by all callers; the most recent ones are kept. Thread-safe.
std::shared_ptr<const ShProjection> sh_projection(const LobeShape& shape);

}  // namespace shlight
