// SPDX-License-Identifier: MIT
//
// A material at many views: the numbers that all lights at a hit share.
#pragma once

#include <algorithm>
#include <cstddef>
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

/// Cosines of views, and their positions in the lobes' tables.
class ViewPositions {
  public:
    /// tabulated: whether any lobe reads tables, and not only the cosines.
    void assign(std::span<const double> cos_theta_o, bool tabulated);

    std::size_t size() const { return size_; }
    std::span<const double> cosine() const { return std::span(cosine_).first(size_); }
    /// ω_o of each view.
    ViewArrays directions() const { return {sine_.data(), cosine_.data(), size_ == 1}; }
    Vec3d direction(std::size_t view) const { return {sine_[view], 0, cosine_[view]}; }
    /// The arrays of view_kernel.h.
    ViewOutput arrays();
    /// Interpolates `width` numbers of tables at the views listed, see interpolate_views().
    void interpolate(const TableNeighbours& neighbours, std::size_t row_size, std::size_t width,
                     std::span<const std::uint32_t> views, float* out, std::size_t stride) const {
        interpolate_views(neighbours, row_size, width, row_.data(), weights_.data(), views, out, stride);
    }
    /// 0, 1, 2 …
    std::span<const std::uint32_t> all() const { return std::span(all_).first(size_); }

  private:
    std::size_t size_ = 0;
    // Padded beyond size_ to a multiple of kViewLanes.
    std::vector<double> cosine_, sine_, fitted_sine_, fitted_cosine_;
    std::vector<float> log_cosine_;
    std::vector<std::uint32_t> row_, all_;
    std::vector<float> weights_;
};

/// One lobe at all views of a ViewPositions. Memory is reused from one assignment to the next.
class LobeViews {
  public:
    /// The shape, whose form is meaningless if it varies.
    const LobeShape& shape() const { return lobe_->shape; }
    LobeShape shape(std::size_t view) const {
        return lobe_->varies() ? with_form(lobe_->shape, form(view)) : lobe_->shape;
    }
    /// lobe_width() at each view.
    const float* widths() const { return widths_.data(); }
    /// lobe_parameter() at each view.
    const float* parameters() const { return anisotropic_ != nullptr ? azimuths_.data() : widths_.data(); }
    /// Whether it is that of an anisotropic table, which has harmonics of its own.
    bool is_anisotropic() const { return anisotropic_ != nullptr; }
    /// Whether each view has a shape of its own, and no harmonics.
    bool has_two_widths() const { return shlight::has_two_widths(lobe_->shape); }
    const ViewPositions& positions() const { return *positions_; }

    /// Whether the cheapest method is chosen for each light; otherwise all lights take harmonics of one order.
    bool chooses() const { return chooses_; }
    /// Whether the views share the lobe's weight.
    bool has_one_weight() const { return weights_.stride == 0; }
    /// The colour that multiplies the lobe's f·cos.
    const Rgb& weight(std::size_t view) const { return weights_.values[view * weights_.stride + index_]; }
    /// Whether the lobe reflects nothing at this view, or at any view.
    bool is_black(std::size_t view) const { return black_[view] != 0; }
    bool is_black() const { return weighed_.empty(); }
    bool any_black() const { return any_black_; }
    /// Order for lights that are not small; 0: their contour is integrated, or the lobe is a mirror.
    int order(std::size_t view) const { return order_[view]; }
    /// Whether the order meets the tolerance; only if assign() was called with `judged`.
    bool within_tolerance(std::size_t view) const { return within_tolerance_[view] != 0; }
    /// Permitted error of radiance ÷ albedo under a light of unit strength; only if chooses().
    const float* tolerances() const { return tolerance_.data(); }
    /// Permitted error of the radiance under a light of unit strength.
    double absolute_tolerance(std::size_t view) const { return double{tolerance_[view]} * albedo_[view]; }
    double albedo(std::size_t view) const { return albedo_[view]; }

    /// Permitted error as a share of the light's radiance, where it exceeds absolute_tolerance(); 0: none.
    double relative_tolerance() const { return relative_tolerance_; }
    /// Precondition: not has_two_widths().
    int largest_order() const { return orders().back(); }
    /// Error of the radiance at largest_order(); only if chooses().
    double error_of_largest_order(std::size_t view) const;

    /// The kernels' arrays of the views in `used`, all of which have this order.
    LobeArrays arrays(int order, std::span<const std::uint32_t> used);
    /// order² coefficients of an anisotropic lobe in the frame of a view, until the next call with another order.
    const float* coefficients(int order, std::uint32_t view);

  private:
    friend class MaterialViews;

    void look_up(const MaterialLobes& material, std::size_t lobe, ViewPositions& positions, const LobeWeights& weights,
                 const LobeForms& forms, bool judged);
    const LobeForm& form(std::size_t view) const { return forms_.values[view * forms_.stride + index_]; }
    void find_parameters(const FitGrid* grid);
    void interpolate(std::size_t column, std::size_t width, std::span<const std::uint32_t> views, float* out,
                     std::size_t stride);
    /// The orders of the fits; empty for a mirror and for Lambert.
    std::span<const int> orders() const;
    void make_room_for_terms(std::size_t stride);
    /// Whether the view's terms are of another order than orders()[which], or none; after that they are taken for it.
    bool lacks_terms(std::uint32_t view, std::size_t which);
    void find_albedos();
    void choose_orders(double tolerance, std::span<const float> tolerance_scales);
    BoostArrays boost_arrays();
    void interpolate_terms(std::size_t which, std::span<const std::uint32_t> used);

    const Lobe* lobe_ = nullptr;
    const BoostedFit* fit_ = nullptr;  // null for a mirror, and where the width varies
    const AnisotropicFit* anisotropic_ = nullptr;
    const FitTable* layout_ = nullptr;  // table of the fit or of the grid; null for mirrors and Lambert
    ViewPositions* positions_ = nullptr;
    bool chooses_ = false, judged_ = false, any_black_ = false;
    LobeWeights weights_{};
    LobeForms forms_{};
    std::size_t index_ = 0;  // number of the lobe in its material
    double relative_tolerance_ = 0;
    std::vector<float> albedo_, tolerance_;
    std::vector<std::uint8_t> black_, order_, within_tolerance_;
    std::vector<std::uint32_t> weighed_;  // views with a weight above 0; other arrays are valid for these only
    AlignedFloats heads_;
    std::vector<float> widths_, azimuths_;     // padded
    std::vector<const FitTable*> neighbours_;  // tables of the grid for each view; empty: one width for all
    std::vector<float> neighbour_weights_;
    std::vector<const float*> columns_;  // their numbers from a column on

    bool has_boosts_ = false;
    std::vector<double> boosts_;  // the arrays of BoostOutput
    std::size_t stride_ = 0;      // numbers per view in terms_
    AlignedFloats terms_;
    std::vector<std::uint8_t> has_terms_;  // for each view 1 + index of the order; 0: none
    std::vector<std::uint32_t> missing_;
};

class MaterialViews {
  public:
    /// judged: whether within_tolerance() will be called. material, weights and forms are kept by reference.
    void assign(const MaterialLobes& material, std::span<const double> cos_theta_o, const LobeWeights& weights,
                const LobeForms& forms, bool judged);

    /// Chooses orders anew, so that each lobe's radiance under a light of this strength has an error of at most
    /// `error`, or of the material's tolerance times that radiance. Precondition: auto_order() of the material.
    void allow_error(double error, const Rgb& strength);

    std::size_t lobe_count() const { return lobe_count_; }
    /// Whether any lobe does.
    bool chooses() const {
        return std::any_of(lobes_.begin(), lobes_.begin() + static_cast<std::ptrdiff_t>(lobe_count_),
                           [](const LobeViews& lobe) { return lobe.chooses(); });
    }
    LobeViews& lobe(std::size_t index) { return lobes_[index]; }
    const ViewPositions& positions() const { return positions_; }

  private:
    void find_tolerance_scales(std::size_t lobe);
    /// The scales for an error of the radiance that does not depend on the albedo.
    void find_tolerance_scales(std::size_t lobe, double error, const Rgb& strength);

    ViewPositions positions_;
    std::size_t lobe_count_ = 0;
    double tolerance_ = 0;
    std::vector<LobeViews> lobes_;
    std::vector<Rgb> whole_;  // albedo of all lobes
    std::vector<float> tolerance_scales_;
};

}  // namespace shlight
