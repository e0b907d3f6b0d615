// SPDX-License-Identifier: MIT
//
// The fits of one shape at all view angles, laid out for looking up many views at once.
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "base/aligned_floats.h"
#include "shlight/lobe_shape.h"
#include "shlight/types.h"

namespace shlight {

/// Orders that a hit may choose from. Beyond the last, cubature over the lobe is both cheaper and more accurate.
inline constexpr std::array<int, 6> kWarpedOrders = {3, 4, 6, 8, 12, 16};

/// View angles are equally spaced in artanh(sinθ_o): fine towards grazing views, where lobes change with cosθ_o.
inline constexpr int kWarpedViews = 49;
double warped_view_cosine(int view);

/// A row for each view, for view_kernel.h: albedo, the shading error of each order, the cosine terms of each order; the
/// errors' head and each order's terms begin on a cache line. All of it is interpolated, between views and tables.
class FitTable {
  public:
    /// Of zeros.
    explicit FitTable(std::span<const int> orders);

    std::span<const int> orders() const { return orders_; }
    /// Index of an order; precondition: it is one of orders().
    std::size_t which(int order) const;

    /// Numbers from row to row, and of what is looked up at once: a head, or the terms of an order with padding.
    std::size_t row_size() const { return row_size_; }
    static constexpr std::size_t kHeadWidth = AlignedFloats::kLine;
    std::size_t width(std::size_t which) const {
        return AlignedFloats::padded(static_cast<std::size_t>(cosine_count(orders_[which])));
    }
    /// Columns.
    static constexpr std::size_t kAlbedo = 0, kShadingErrors = 1;
    std::size_t terms(std::size_t which) const { return first_[which]; }

    /// Row -1 is the view beyond the normal, where terms of odd degree change sign.
    std::span<float> row(int view) {
        return values().subspan(static_cast<std::size_t>(view + 1) * row_size_, row_size_);
    }
    /// All rows, from -1 on.
    std::span<const float> values() const { return {values_.data(), (kWarpedViews + 1) * row_size_}; }
    std::span<float> values() { return {values_.data(), (kWarpedViews + 1) * row_size_}; }

    /// Of one view: `width` numbers from a column on.
    void look_up(double cos_theta_o, std::size_t column, std::span<float> out) const;

  private:
    std::vector<int> orders_;
    std::vector<std::size_t> first_;  // column of each order
    std::size_t row_size_;
    AlignedFloats values_;
};

/// Fits one lobe at one view, into a row.
void fit_row(const LobeShape& shape, int view, FitTable& table);
/// Fits all views of one shape.
FitTable fit_table(const LobeShape& shape, std::span<const int> orders);

/// The fits of GGX lobes of all roughnesses, which differ in nothing else: tables of some, each fitted when it is first
/// needed, between which cubic interpolation finds all others. Any number of threads may read it.
class FitGrid {
  public:
    /// Takes only Fresnel factor and ior of the shape. order: the only one, or 0 for kWarpedOrders.
    FitGrid(const GgxShape& shape, int order);

    static constexpr std::size_t kNeighbours = 4;
    struct Neighbours {
        std::array<const FitTable*, kNeighbours> tables;
        std::array<float, kNeighbours> weights;
    };
    Neighbours neighbours(double alpha) const;
    /// Precondition: not a mirror.
    FitTable interpolated(double alpha) const;
    /// Fits all; their size in bytes.
    std::size_t complete() const;

  private:
    const FitTable& table(int roughness) const;

    struct Entry {
        std::once_flag once;
        std::optional<FitTable> table;
    };
    GgxShape shape_;
    std::vector<int> orders_;
    mutable std::vector<Entry> entries_;
};

/// Shared by everyone who asks for the same one; the last ones asked for are kept. Thread-safe.
std::shared_ptr<const FitGrid> fit_grid(const GgxShape& shape, int order);

}  // namespace shlight
