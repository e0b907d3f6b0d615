// SPDX-License-Identifier: MIT
//
// "Model no more than a scene needs": a material's lobes, and how exactly each must be shaded at each view.
#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "lobes/fit_table.h"
#include "shlight/bsdf.h"
#include "shlight/types.h"

namespace shlight {

/// The least distance [rad] over which f·cos of a lobe changes at this view; 0 for a mirror.
double narrowest(const LobeShape& lobe, double cos_theta_o);
/// The distance over which it changes around a direction wi, all unit vectors: on the sphere where the bell is round, a
/// step of wi is at most 1/α long, over the length of the half vector there.
double distance_of_change(const LobeShape& lobe, const Vec3d& wi, const Vec3d& wo);

/// Whether directions are spread alike by both lobes of a material, at all hits.
bool spread_alike(const Lobe& a, const Lobe& b);

/// Weights of a material's lobes: of lobe i at view v, values[v · stride + i].
struct LobeWeights {
    std::span<const Rgb> values;
    std::size_t stride;  ///< 0: the views share their weights
};

/// Widths of lobes that vary, laid out as LobeWeights.
struct LobeWidths {
    std::span<const float> values;  ///< empty: none varies
    std::size_t stride;
};

class MaterialLobes {
  public:
    /// order: the only one, 1 … 64, or 0 to meet the tolerance: of the radiance ÷ albedo of the whole material, in each
    /// colour channel.
    MaterialLobes(std::span<const Lobe> lobes, int order, double tolerance);

    /// Those that are not black.
    std::span<const Lobe> lobes() const { return lobes_; }
    /// What a lobe is shaded with; null for a mirror, and for one whose width varies.
    const WarpedFit* fit(std::size_t lobe) const { return auto_order_ ? lobes_[lobe].fit.get() : fits_[lobe].get(); }
    /// What a lobe whose width varies is shaded with; null for others.
    const FitGrid* grid(std::size_t lobe) const { return grids_[lobe].get(); }
    /// Whether any lobe's width varies.
    bool varies() const {
        return std::any_of(lobes_.begin(), lobes_.end(), [](const Lobe& lobe) { return lobe.varying_width != 0; });
    }
    /// Whether each view and light may have an order of its own; otherwise a fit has only one.
    bool auto_order() const { return auto_order_; }
    double tolerance() const { return tolerance_; }
    /// The lobes' weights at these views, in `values`, which is to outlive the result.
    LobeWeights weights(std::span<const double> cos_theta_o, std::vector<Rgb>& values) const;
    /// The least distance [rad] over which f·cos changes at this view: of its narrowest lobe; 0 for a mirror. widths:
    /// of each lobe, where it varies.
    double narrowest(double cos_theta_o, std::span<const float> widths) const;
    /// A lobe's shape where its width, if it varies, is this.
    LobeShape shape(std::size_t lobe, float width) const {
        return lobes_[lobe].varying_width != 0 ? with_width(lobes_[lobe].shape, double{width}) : lobes_[lobe].shape;
    }

  private:
    std::vector<Lobe> lobes_;
    std::vector<std::shared_ptr<const WarpedFit>> fits_;  // of the only order; otherwise empty
    std::vector<std::shared_ptr<const FitGrid>> grids_;
    bool auto_order_;
    double tolerance_;
};

}  // namespace shlight
