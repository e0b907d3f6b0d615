// SPDX-License-Identifier: MIT
//
// Fits of GGX lobes, tabulated over roughness and view, between which GGX lobes are interpolated.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "base/recent_values.h"
#include "lobes/fit_table.h"
#include "math/cubic_stencil.h"
#include "shlight/boosted_fit.h"

namespace shlight {
namespace {

/// Roughnesses are equally spaced in log(α + kAlphaOffset): below the offset a lobe's boosted image no longer depends
/// on α.
constexpr int kRoughnesses = 32;
constexpr double kAlphaOffset = 0.02;
constexpr double kLeastTabulatedAlpha = 2e-4;
const double kFirstLog = std::log(kLeastTabulatedAlpha + kAlphaOffset);
const double kLogStep = (std::log(1 + kAlphaOffset) - kFirstLog) / (kRoughnesses - 1);

}  // namespace

FitGrid::FitGrid(const GgxShape& shape, int order)
    : shape_(shape),
      orders_(order == 0 ? std::vector<int>(kBoostedOrders.begin(), kBoostedOrders.end()) : std::vector<int>{order}),
      tables_(kRoughnesses) {}

FitGrid::Neighbours FitGrid::neighbours(double alpha) const {
    const double log_alpha = std::log(std::max(alpha, kLeastTabulatedAlpha) + kAlphaOffset);
    const CubicStencil stencil((log_alpha - kFirstLog) / kLogStep, 0, kRoughnesses);
    Neighbours found{{}, stencil.weights};
    for (std::size_t k = 0; k < kNeighbours; ++k) {
        const std::size_t number = static_cast<std::size_t>(stencil.first) + k;
        found.tables[k] = &tables_.get(number, [&] {
            const double tabulated = std::exp(kFirstLog + kLogStep * static_cast<double>(number)) - kAlphaOffset;
            GgxShape shape = shape_;
            shape.alpha = tabulated;
            return fit_table(shape, orders_);
        });
    }
    return found;
}

double FitGrid::albedo(double alpha, double cos_theta_o) const {
    const Neighbours between = neighbours(alpha);
    double sum = 0;
    for (std::size_t k = 0; k < kNeighbours; ++k) {
        float albedo = 0;
        between.tables[k]->look_up(cos_theta_o, FitTable::kAlbedo, {&albedo, 1});
        sum += double{between.weights[k]} * double{albedo};
    }
    return sum;
}

FitTable FitGrid::interpolated(double alpha) const {
    const Neighbours between = neighbours(alpha);
    FitTable sum(orders_);
    for (std::size_t k = 0; k < kNeighbours; ++k) {
        const auto from = between.tables[k]->values();
        std::transform(from.begin(), from.end(), sum.values().begin(), sum.values().begin(),
                       [w = between.weights[k]](float value, float total) { return total + w * value; });
    }
    return sum;
}

std::shared_ptr<const FitGrid> fit_grid(const GgxShape& shape, int order) {
    constexpr std::size_t kRecentGrids = 16;
    static RecentValues<std::pair<GgxShape, int>, FitGrid> recent(kRecentGrids);
    const bool has_ior = shape.fresnel == Fresnel::dielectric;
    const GgxShape key = {1, shape.fresnel, has_ior ? shape.ior : GgxShape{1}.ior, shape.distribution};
    return recent.get({key, order}, [&] { return std::make_shared<const FitGrid>(key, order); });
}

}  // namespace shlight
