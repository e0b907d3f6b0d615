// SPDX-License-Identifier: MIT
#include "lobes/ggx_table.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "math/cubic_stencil.h"

namespace shlight {
namespace {

/// Roughness rows are equally spaced in log(α + kAlphaOffset): below the offset a lobe's image in its own warp no
/// longer depends on α.
constexpr double kAlphaOffset = 0.02;
constexpr double kLeastTabulatedAlpha = 2e-4;
const double kFirstLog = std::log(kLeastTabulatedAlpha + kAlphaOffset);
const double kLogRange = std::log(1 + kAlphaOffset) - kFirstLog;

}  // namespace

GgxTable& GgxTable::get() {
    static GgxTable table;
    return table;
}

const FitTable& GgxTable::row(Fresnel fresnel, int index) {
    Row& row = (fresnel == Fresnel::one ? one_ : schlick_)[static_cast<std::size_t>(index)];
    std::call_once(row.once, [&] {
        const double alpha = std::exp(kFirstLog + kLogRange * index / (kRows - 1)) - kAlphaOffset;
        row.fits.emplace(fit_table(GgxShape{alpha, fresnel}, kWarpedOrders));
    });
    return *row.fits;
}

FitTable GgxTable::fits(const GgxShape& shape) {
    const double log_alpha = std::log(std::max(shape.alpha, kLeastTabulatedAlpha) + kAlphaOffset);
    const CubicStencil s((log_alpha - kFirstLog) / kLogRange * (kRows - 1), 0, kRows);
    std::vector<float> nodes(row(shape.fresnel, s.first).nodes().size(), 0.0F);
    for (int k = 0; k < 4; ++k) {
        const auto from = row(shape.fresnel, s.first + k).nodes();
        std::transform(from.begin(), from.end(), nodes.begin(), nodes.begin(),
                       [w = s.weights[k]](float value, float sum) { return sum + w * value; });
    }
    return {row(shape.fresnel, s.first).layout(), std::move(nodes)};
}

std::size_t GgxTable::build() {
    std::size_t bytes = 0;
    for (const Fresnel fresnel : {Fresnel::one, Fresnel::schlick}) {
        for (int i = 0; i < kRows; ++i) {
            bytes += row(fresnel, i).nodes().size_bytes();
        }
    }
    return bytes;
}

}  // namespace shlight
