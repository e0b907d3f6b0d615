// SPDX-License-Identifier: MIT
#include "warped_row.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "shlight/warped_fit.h"

namespace shlight {
namespace {

/// artanh(sinθ_o) of the most grazing view that is fitted.
const double kFarthestView = std::acosh(1 / kLeastFittedCosine);

CubicStencil view_stencil(double cos_theta_o) {
    const double cosine = std::clamp(cos_theta_o, kLeastFittedCosine, 1.0);
    return {std::acosh(1 / cosine) / kFarthestView * (kWarpedViews - 1), -1, kWarpedViews};
}

}  // namespace

double warped_view_cosine(int node) {
    return 1 / std::cosh(kFarthestView * node / (kWarpedViews - 1));
}

NodeLayout::NodeLayout(std::span<const int> orders)
    : orders_(orders.begin(), orders.end()), size_(1 + 2 * orders.size()) {
    for (const int order : orders_) {
        first_.push_back(size_);
        size_ += static_cast<std::size_t>(cosine_count(order));
    }
}

std::size_t NodeLayout::which(int order) const {
    return static_cast<std::size_t>(std::find(orders_.begin(), orders_.end(), order) - orders_.begin());
}

CubicStencil::CubicStencil(double position, int least, int count)
    : first(std::clamp(static_cast<int>(std::floor(position)) - 1, least, count - 4)) {
    const auto t = static_cast<float>(position - first);  // 1 … 2 between the middle nodes
    weights = {-(t - 1) * (t - 2) * (t - 3) / 6, t * (t - 2) * (t - 3) / 2, -t * (t - 1) * (t - 3) / 2,
               t * (t - 1) * (t - 2) / 6};
}

WarpedRow::WarpedRow(NodeLayout layout, std::vector<float> nodes)
    : layout_(std::move(layout)), nodes_(std::move(nodes)) {}

float WarpedRow::value(double cos_theta_o, std::size_t offset) const {
    const CubicStencil s = view_stencil(cos_theta_o);
    float sum = 0;
    for (int k = 0; k < 4; ++k) {
        sum += s.weights[k] * nodes_[static_cast<std::size_t>(std::abs(s.first + k)) * layout_.size() + offset];
    }
    return sum;
}

void WarpedRow::coefficients(double cos_theta_o, std::size_t which, float* cosine_terms) const {
    const CubicStencil s = view_stencil(cos_theta_o);
    const int order = layout_.orders()[which];
    const int count = cosine_count(order);
    std::fill_n(cosine_terms, count, 0.0F);
    for (int k = 0; k < 4; ++k) {
        const auto node = static_cast<std::size_t>(std::abs(s.first + k));
        const float* terms = &nodes_[node * layout_.size() + layout_.coefficients(which)];
        const float w = s.weights[k];
        if (s.first + k >= 0) {
            for (int i = 0; i < count; ++i) {
                cosine_terms[i] += w * terms[i];
            }
            continue;
        }
        // Past the normal the view is mirrored: terms of odd degree change sign.
        for (int l = 0, i = 0; l < order; ++l) {
            for (int m = 0; m <= l; ++m, ++i) {
                cosine_terms[i] += (m % 2 == 0 ? w : -w) * terms[i];
            }
        }
    }
}

WarpedRow fit_warped_row(const GgxShape& shape, std::span<const int> orders) {
    const NodeLayout layout(orders);
    std::vector<float> nodes(kWarpedViews * layout.size());
    const auto fit = [&](int node) {
        const auto out = std::span(nodes).subspan(static_cast<std::size_t>(node) * layout.size(), layout.size());
        fit_warped_node(shape, warped_view_cosine(node), layout, out);
    };
    // Isolated: a thread that waits here must not pick up unrelated work that may ask for this very fit.
    tbb::this_task_arena::isolate([&] { tbb::parallel_for(0, kWarpedViews, fit); });
    return {layout, std::move(nodes)};
}

}  // namespace shlight
