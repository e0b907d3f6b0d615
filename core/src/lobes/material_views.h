// SPDX-License-Identifier: MIT
//
// A material at many views: everything that all lights at a hit share.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/aligned_floats.h"
#include "lobes/fit_table.h"
#include "lobes/material_lobes.h"
#include "lobes/view_kernel.h"
#include "shlight/types.h"
#include "simd/lobe_arrays.h"

namespace shlight {

/// Cosines of views, and where their lobes' tables are read.
class ViewPositions {
  public:
    /// tabulated: whether any lobe needs more than the cosines.
    void assign(std::span<const double> cos_theta_o, bool tabulated);

    std::size_t size() const { return size_; }
    std::span<const double> cosine() const { return std::span(cosine_).first(size_); }
    /// ω_o of each.
    ViewArrays directions() const { return {sine_.data(), cosine_.data(), size_ == 1}; }
    Vec3d direction(std::size_t view) const { return {sine_[view], 0, cosine_[view]}; }
    /// As view_kernel.h reads them.
    ViewOutput arrays();
    /// `width` numbers from a column on of the rows `views`, as interpolate_views.
    void interpolate(const FitTable& table, std::size_t column, std::size_t width, std::span<const std::uint32_t> views,
                     float* out, std::size_t stride) const;
    void interpolate(const TableNeighbours& neighbours, std::size_t row_size, std::size_t width,
                     std::span<const std::uint32_t> views, float* out, std::size_t stride) const {
        interpolate_views(neighbours, row_size, width, row_.data(), weights_.data(), views, out, stride);
    }
    /// 0, 1, 2 …
    std::span<const std::uint32_t> all() const { return std::span(all_).first(size_); }

  private:
    std::size_t size_ = 0;
    // Longer than size_, as view_kernel.h wants it.
    std::vector<double> cosine_, sine_, fitted_sine_, fitted_cosine_;
    std::vector<float> log_cosine_;
    std::vector<std::uint32_t> row_, all_;
    std::vector<float> weights_;
};

/// One lobe at these views. Keeps its memory from one assignment to the next.
class LobeViews {
  public:
    /// Where its width varies, that of none of the views.
    const LobeShape& shape() const { return lobe_->shape; }
    LobeShape shape(std::size_t view) const {
        return lobe_->varying_width != 0 ? with_width(lobe_->shape, double{widths_[view]}) : lobe_->shape;
    }
    /// lobe_width() at each view.
    const float* widths() const { return widths_.data(); }
    const ViewPositions& positions() const { return *positions_; }

    /// Whether each light is integrated in the way that is cheapest for it, or else all by harmonics of one order.
    bool chooses() const { return chooses_; }
    /// Whether the views share the lobe's weight.
    bool has_one_weight() const { return weights_.stride == 0; }
    /// What values of the lobe are multiplied by.
    const Rgb& weight(std::size_t view) const { return weights_.values[view * weights_.stride + index_]; }
    /// Reflects nothing at all.
    bool is_black(std::size_t view) const { return black_[view] != 0; }
    bool is_black() const { return weighed_.empty(); }
    bool any_black() const { return any_black_; }
    /// For lights that are not small; 0: their outline is integrated, or the lobe is a mirror.
    int order(std::size_t view) const { return order_[view]; }
    /// Whether the order keeps within the tolerance; only if that was to be judged.
    bool within_tolerance(std::size_t view) const { return within_tolerance_[view] != 0; }
    /// Of the radiance ÷ albedo of a light of unit strength; only if the lobe chooses.
    const float* tolerances() const { return tolerance_.data(); }
    /// Of the radiance.
    double absolute_tolerance(std::size_t view) const { return double{tolerance_[view]} * albedo_[view]; }
    double albedo(std::size_t view) const { return albedo_[view]; }

    /// What suffices beside absolute_tolerance(): a share of what the light brings; 0: nothing does.
    double relative_tolerance() const { return relative_tolerance_; }
    int largest_order() const { return layout_->orders().back(); }
    /// Of the radiance; only if the lobe chooses.
    double error_of_largest_order(std::size_t view) const;

    /// As the kernels read it. order: of those views that `used` lists.
    LobeArrays arrays(int order, std::span<const std::uint32_t> used);
    Warp warp(std::size_t view) const { return lobe_warp(shape(view), positions_->cosine()[view]); }

  private:
    friend class MaterialViews;

    void look_up(const MaterialLobes& material, std::size_t lobe, ViewPositions& positions, const LobeWeights& weights,
                 const LobeWidths& widths, bool judged);
    void find_widths(const LobeWidths& widths, const FitGrid* grid);
    void interpolate(std::size_t column, std::size_t width, std::span<const std::uint32_t> views, float* out,
                     std::size_t stride) const;
    void find_albedos();
    void choose_orders(double tolerance, std::span<const float> allowances);
    WarpArrays warp_arrays();
    void interpolate_terms(std::size_t which, std::span<const std::uint32_t> used);

    const Lobe* lobe_ = nullptr;
    const WarpedFit* fit_ = nullptr;    // null: a mirror, or the width varies
    const FitTable* layout_ = nullptr;  // of the fit or of the grid's tables; null: a mirror, or Lambert
    ViewPositions* positions_ = nullptr;
    bool chooses_ = false, judged_ = false, any_black_ = false;
    LobeWeights weights_{};
    std::size_t index_ = 0;  // of the lobe in its material
    double relative_tolerance_ = 0;
    std::vector<float> albedo_, tolerance_;
    std::vector<std::uint8_t> black_, order_, within_tolerance_;
    std::vector<std::uint32_t> weighed_;  // views at which the weight is not 0, of which alone anything else is known
    AlignedFloats heads_;
    std::vector<float> widths_;                // padded
    std::vector<const FitTable*> neighbours_;  // of each view, in the grid; empty: the width is the same
    std::vector<float> neighbour_weights_;
    mutable std::vector<const float*> columns_;  // likewise, from a column on

    bool has_warps_ = false;
    std::vector<double> warps_;  // the arrays of WarpOutput
    std::size_t stride_ = 0;     // of terms_
    AlignedFloats terms_;
    std::vector<std::uint8_t> has_terms_;  // of each view: for which order, counted from 1
    std::vector<std::uint32_t> missing_;
};

class MaterialViews {
  public:
    /// judged: whether each lobe's within_tolerance() will be asked for. material and weights are kept by reference.
    void assign(const MaterialLobes& material, std::span<const double> cos_theta_o, const LobeWeights& weights,
                const LobeWidths& widths, bool judged);

    /// Chooses anew, so that each lobe's radiance under a light of this strength is wrong by no more than `error`, or
    /// the material's tolerance of that radiance. Precondition: auto_order() of the material.
    void allow(double error, const Rgb& strength);

    std::size_t lobe_count() const { return lobe_count_; }
    LobeViews& lobe(std::size_t index) { return lobes_[index]; }
    const ViewPositions& positions() const { return positions_; }

  private:
    void find_allowances(std::size_t lobe);
    /// The same where an error is allowed whatever the albedo.
    void find_allowances(std::size_t lobe, double error, const Rgb& strength);

    ViewPositions positions_;
    std::size_t lobe_count_ = 0;
    double tolerance_ = 0;
    std::vector<LobeViews> lobes_;
    std::vector<Rgb> whole_;  // albedo of all lobes
    std::vector<float> allowances_;
};

}  // namespace shlight
