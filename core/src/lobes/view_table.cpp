// SPDX-License-Identifier: MIT
#include "lobes/view_table.h"

#include <algorithm>
#include <cstdlib>

#include "lobes/view_kernel.h"
#include "shlight/types.h"

namespace shlight {
namespace {

static_assert(ViewTable::kResiduals + kWarpedOrders.size() <= ViewTable::kHeadWidth);

/// One interpolated row.
void interpolate_one(double cos_theta_o, const float* table, std::size_t width, float* out) {
    std::array<double, kViewLanes> cosine;
    cosine.fill(cos_theta_o);
    std::array<double, kViewLanes> sine, fitted_sine, fitted_cosine;
    std::array<float, kViewLanes> log_cosine;
    std::array<std::uint32_t, kViewLanes> row;
    std::array<float, 4 * kViewLanes> weights;
    find_views(cosine.data(), 1,
               {sine.data(), fitted_sine.data(), fitted_cosine.data(), log_cosine.data(), row.data(), weights.data()});
    constexpr std::uint32_t kFirst = 0;
    interpolate_views(table, width, row.data(), weights.data(), {&kFirst, 1}, out, width);
}

}  // namespace

ViewTable::ViewTable(const FitTable& row) : orders_(row.layout().orders().begin(), row.layout().orders().end()) {
    const NodeLayout& layout = row.layout();
    constexpr int kBeyond = -1;
    heads_.grow((kWarpedViews + 1) * kHeadWidth);
    float* head = heads_.data();
    for (int node = kBeyond; node < kWarpedViews; ++node, head += kHeadWidth) {
        const auto from = row.node(std::abs(node));
        head[kAlbedo] = from[NodeLayout::albedo()];
        for (std::size_t i = 0; i < orders_.size(); ++i) {
            head[kShadingErrors + i] = from[NodeLayout::shading_error(i)];
            head[kResiduals + i] = from[NodeLayout::residual(i)];
        }
    }
    terms_.resize(orders_.size());
    for (std::size_t i = 0; i < orders_.size(); ++i) {
        terms_[i].grow((kWarpedViews + 1) * width(i));
        float* out = terms_[i].data();
        for (int node = kBeyond; node < kWarpedViews; ++node, out += width(i)) {
            const float* from = row.node(std::abs(node)).data() + layout.coefficients(i);
            for (int l = 0; l < orders_[i]; ++l) {
                for (int m = 0; m <= l; ++m) {
                    const int at = cosine_index(l, m);
                    out[at] = node == kBeyond && m % 2 == 1 ? -from[at] : from[at];
                }
            }
        }
    }
}

std::size_t ViewTable::which(int order) const {
    return static_cast<std::size_t>(std::find(orders_.begin(), orders_.end(), order) - orders_.begin());
}

std::size_t ViewTable::width(std::size_t which) const {
    return AlignedFloats::padded(static_cast<std::size_t>(cosine_count(orders_[which])));
}

ViewTable::Head ViewTable::head(double cos_theta_o) const {
    alignas(64) Head head;
    interpolate_one(cos_theta_o, heads(), kHeadWidth, head.data());
    return head;
}

void ViewTable::terms(double cos_theta_o, std::size_t which, float* cosine_terms) const {
    AlignedFloats row;
    row.grow(width(which));
    interpolate_one(cos_theta_o, terms(which), width(which), row.data());
    std::copy_n(row.data(), cosine_count(orders_[which]), cosine_terms);
}

}  // namespace shlight
