// SPDX-License-Identifier: MIT
#include "lobes/fit_table.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>

#include "shlight/warped_fit.h"

namespace shlight {
namespace {

/// artanh(sinθ_o) of the most grazing view that is fitted.
const double kFarthestView = std::acosh(1 / kLeastFittedCosine);

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

FitTable::FitTable(NodeLayout layout, std::vector<float> nodes)
    : layout_(std::move(layout)), nodes_(std::move(nodes)) {}

FitTable fit_table(const LobeShape& shape, std::span<const int> orders) {
    const NodeLayout layout(orders);
    std::vector<float> nodes(kWarpedViews * layout.size());
    const auto fit = [&](int node) {
        const auto out = std::span(nodes).subspan(static_cast<std::size_t>(node) * layout.size(), layout.size());
        fit_node(shape, warped_view_cosine(node), layout, out);
    };
    // Isolated: a thread that waits here must not pick up unrelated work that may ask for this very fit.
    tbb::this_task_arena::isolate([&] { tbb::parallel_for(0, kWarpedViews, fit); });
    return {layout, std::move(nodes)};
}

}  // namespace shlight
