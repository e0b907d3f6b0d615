// SPDX-License-Identifier: MIT
//
// The fits of one GGX shape at all view angles, laid out for looking up many views at once.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/aligned_floats.h"
#include "lobes/fit_table.h"

namespace shlight {

/// Tables for view_kernel.h: one of what is known of a view beside its coefficients, and one of coefficients for each
/// order. Their first row is the view beyond the normal, where terms of odd degree change sign.
class ViewTable {
  public:
    explicit ViewTable(const FitTable& row);

    std::span<const int> orders() const { return orders_; }
    /// Index of an order; precondition: it is one of orders().
    std::size_t which(int order) const;

    /// A view's head: albedo, then the shading error of each order, then the residuals.
    static constexpr std::size_t kHeadWidth = AlignedFloats::kLine;
    static constexpr std::size_t kAlbedo = 0, kShadingErrors = 1, kResiduals = 1 + kWarpedOrders.size();
    using Head = std::array<float, kHeadWidth>;
    const float* heads() const { return heads_.data(); }

    const float* terms(std::size_t which) const { return terms_[which].data(); }
    std::size_t width(std::size_t which) const;

    /// Of one view.
    Head head(double cos_theta_o) const;
    void terms(double cos_theta_o, std::size_t which, float* cosine_terms) const;

  private:
    std::vector<int> orders_;
    AlignedFloats heads_;
    std::vector<AlignedFloats> terms_;  // of each order
};

}  // namespace shlight
