// SPDX-License-Identifier: MIT
//
// f·cos as harmonics of the whole sphere, 0 below the horizon: what an expansion of light that is not clipped at the
// horizon is multiplied with. (Least-squares fits as in plain_fit.h may be anything down there.)
#pragma once

#include <memory>
#include <vector>

#include "shlight/lobe_shape.h"

namespace shlight {

/// One shape at all view angles, ω_o = (sinθ_o, 0, cosθ_o): only cosine terms are not 0.
class ShProjection {
  public:
    /// Precondition: not a mirror.
    explicit ShProjection(const LobeShape& shape);

    /// Whether only degree 0 is there, at all views alike.
    bool is_zonal() const { return node_count() == 1; }
    /// Writes the cosine_count(order) cosine terms for one view angle.
    void coefficients(float cos_theta_o, int order, float* cosine_terms) const;

    /// View angles that are tabulated: 1, or those of view_grid.h.
    std::size_t node_count() const { return powers_.size() / kMaxOrder; }
    /// Σ_m f_lm² of the bands l = 0 … 63 at a node.
    const float* powers(std::size_t node) const { return &powers_[node * kMaxOrder]; }
    /// The same of all bands that follow.
    float tail(std::size_t node) const { return tails_[node]; }

  private:
    void add_node(const double* cosine_terms, double norm_squared);

    std::vector<float> terms_;  // nodes × kCosineMax
    std::vector<float> powers_, tails_;
};

/// The lobe of a shape, shared by everyone who asks for the same one; the last ones asked for are kept. Thread-safe.
std::shared_ptr<const ShProjection> sh_projection(const LobeShape& shape);

}  // namespace shlight
