// SPDX-License-Identifier: MIT
//
// The fits of one shape at all view angles.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "shlight/lobe_shape.h"

namespace shlight {

/// Orders that a hit may choose from. Beyond the last, cubature over the lobe is both cheaper and more accurate.
inline constexpr std::array<int, 6> kWarpedOrders = {3, 4, 6, 8, 12, 16};

/// View angles are equally spaced in artanh(sinθ_o): fine towards grazing views, where lobes change with cosθ_o.
inline constexpr int kWarpedViews = 49;
double warped_view_cosine(int node);

/// What is known of one lobe at one view: albedo, per order two errors, then the coefficients of each order in turn.
/// A plain row of numbers, because that is what is interpolated.
class NodeLayout {
  public:
    explicit NodeLayout(std::span<const int> orders);

    std::span<const int> orders() const { return orders_; }
    std::size_t size() const { return size_; }
    static std::size_t albedo() { return 0; }
    static std::size_t shading_error(std::size_t which) { return 1 + 2 * which; }
    static std::size_t residual(std::size_t which) { return 2 + 2 * which; }
    std::size_t coefficients(std::size_t which) const { return first_[which]; }

  private:
    std::vector<int> orders_;
    std::vector<std::size_t> first_;
    std::size_t size_;
};

/// Fits one lobe at one view; out: layout.size() values.
void fit_node(const LobeShape& shape, double cos_theta_o, const NodeLayout& layout, std::span<float> out);

class FitTable {
  public:
    FitTable(NodeLayout layout, std::vector<float> nodes);

    const NodeLayout& layout() const { return layout_; }
    std::span<const float> nodes() const { return nodes_; }
    /// What is known at one view angle.
    std::span<const float> node(int index) const {
        return nodes().subspan(static_cast<std::size_t>(index) * layout_.size(), layout_.size());
    }

  private:
    NodeLayout layout_;
    std::vector<float> nodes_;  // kWarpedViews × layout.size()
};

/// Fits all views of one shape.
FitTable fit_table(const LobeShape& shape, std::span<const int> orders);

}  // namespace shlight
