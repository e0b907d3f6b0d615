// SPDX-License-Identifier: MIT
//
// The harmonic fits of one lobe shape at all view angles, laid out for many look-ups at once.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "base/aligned_floats.h"
#include "base/recent_values.h"
#include "shlight/lobe_shape.h"
#include "shlight/types.h"

namespace shlight {

/// Orders that a hit may choose from. Beyond the last one cubature over the lobe is cheaper and more accurate.
inline constexpr std::array<int, 6> kBoostedOrders = {3, 4, 6, 8, 12, 16};

/// View angles are equally spaced in artanh(sinθ_o): fine towards grazing views, where lobes change with cosθ_o.
inline constexpr int kBoostedViews = 49;
double boosted_view_cosine(int view);

/// A row for each view, for view_kernel.h: a head with the albedo and the shading error of each order, then the cosine
/// terms of each order. The head and the terms of each order begin on a cache line. All numbers are interpolated,
/// between views and between tables.
class FitTable {
  public:
    /// A table filled with zeros.
    explicit FitTable(std::span<const int> orders);

    std::span<const int> orders() const { return orders_; }
    /// Index of an order; precondition: it is one of orders().
    std::size_t which(int order) const;

    /// Floats per row, per head, and per block of an order's terms with padding.
    std::size_t row_size() const { return row_size_; }
    static constexpr std::size_t kHeadWidth = AlignedFloats::kLine;
    std::size_t width(std::size_t which) const {
        return AlignedFloats::padded(static_cast<std::size_t>(cosine_count(orders_[which])));
    }
    /// Columns within a row.
    static constexpr std::size_t kAlbedo = 0, kShadingErrors = 1;
    std::size_t terms(std::size_t which) const { return first_[which]; }

    /// Row -1 is the view beyond the normal, where terms of odd degree change sign.
    std::span<float> row(int view) {
        return values().subspan(static_cast<std::size_t>(view + 1) * row_size_, row_size_);
    }
    /// All rows, from -1 on.
    std::span<const float> values() const { return {values_.data(), (kBoostedViews + 1) * row_size_}; }
    std::span<float> values() { return {values_.data(), (kBoostedViews + 1) * row_size_}; }

    /// Interpolates out.size() numbers from `column` on at one view.
    void look_up(double cos_theta_o, std::size_t column, std::span<float> out) const;

  private:
    std::vector<int> orders_;
    std::vector<std::size_t> first_;  // column of each order
    std::size_t row_size_;
    AlignedFloats values_;
};

/// Eq. 39 of docs/theory.md. A cap's coefficients fall as λ_l ≤ √(8π/l³) (Funk–Hecke), and the fit's error lies in
/// bands ≥ order, except for what the ridge λ takes from the low bands. That part is the missing light, which a large
/// light receives undiminished.
double shading_error(double squared_error, double missing_light, int order, double albedo);

/// Fits one lobe at one view, into a row.
void fit_row(const LobeShape& shape, int view, FitTable& table);
/// Fits all views of one shape.
FitTable fit_table(const LobeShape& shape, std::span<const int> orders);

/// The fits of GGX lobes that differ only in roughness: tables at some roughnesses, each fitted when it is first
/// needed, between which cubic interpolation finds all others. Any number of threads may read it.
class FitGrid {
  public:
    /// Only Fresnel factor and ior of the shape are used. order: the only one, or 0 for kBoostedOrders.
    FitGrid(const GgxShape& shape, int order);

    static constexpr std::size_t kNeighbours = 4;
    struct Neighbours {
        std::array<const FitTable*, kNeighbours> tables;
        std::array<float, kNeighbours> weights;
    };
    Neighbours neighbours(double alpha) const;
    /// Precondition: not a mirror.
    double albedo(double alpha, double cos_theta_o) const;
    /// Precondition: not a mirror.
    FitTable interpolated(double alpha) const;

  private:
    GgxShape shape_;
    std::vector<int> orders_;
    ValuesByNumber<FitTable> tables_;
};

/// The grid of a Fresnel factor, ior and order, shared by all callers; the most recent ones are kept. Thread-safe.
std::shared_ptr<const FitGrid> fit_grid(const GgxShape& shape, int order);

}  // namespace shlight
