// SPDX-License-Identifier: MIT
//
// f·cos projected onto harmonics of the whole sphere (Eq. 3 of the paper), 0 below the horizon. It is multiplied with
// expansions of light that are not clipped at the horizon. (The fits of plain_fit.h have arbitrary values there.)
#pragma once

#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "lobes/anisotropic_views.h"
#include "shlight/lobe_shape.h"

namespace shlight {

/// One shape at all view angles, ω_o = (sinθ_o, 0, cosθ_o). All sine terms vanish unless it is anisotropic.
class ShProjection {
  public:
    /// Precondition: not a mirror.
    explicit ShProjection(const LobeShape& shape);

    /// Whether only terms of degree 0 exist and the view does not matter.
    bool is_zonal() const { return !views_ && node_count() == 1; }
    bool has_sines() const { return views_.has_value(); }
    /// Writes the cosine_count(order) cosine terms, or sine terms, for one view. azimuth: see TableShape.
    void coefficients(float cos_theta_o, float azimuth, bool sines, int order, float* terms) const;
    /// The azimuth of the view in the frame of the coefficients.
    double azimuth_of_view(float azimuth) const { return views_ && views_->are_of_tangent() ? double{azimuth} : 0.0; }

    /// Number of tabulated views: 1, those of view_grid.h, or those of AnisotropicViews.
    std::size_t node_count() const { return powers_.size() / kMaxOrder; }
    /// The nodes around a view.
    RowTaps nodes(double cos_theta_o, double azimuth) const;
    /// Σ_m f_lm² of the bands l = 0 … 63 at a node.
    const float* powers(std::size_t node) const { return &powers_[node * kMaxOrder]; }
    /// Σ f_lm² of all bands from 64 on.
    float tail(std::size_t node) const { return tails_[node]; }

  private:
    /// terms: cosines, and sines of an anisotropic shape.
    void add_node(std::initializer_list<std::span<const double>> terms, double norm_squared);

    std::optional<AnisotropicViews> views_;  // of an anisotropic shape
    std::vector<float> terms_;               // nodes × kCosineMax, or twice as many with sine terms
    std::vector<float> powers_, tails_;
};

/// The projection of a shape, shared by all callers; the most recent ones are kept. Thread-safe.
std::shared_ptr<const ShProjection> sh_projection(const LobeShape& shape);

}  // namespace shlight
