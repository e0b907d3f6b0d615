// SPDX-License-Identifier: MIT
//
// The fits that all GGX lobes interpolate in, tabulated over roughness and view: of Fresnel factors without a
// parameter.
#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <optional>

#include "lobes/fit_table.h"
#include "math/cubic_stencil.h"
#include "shlight/warped_fit.h"

namespace shlight {
namespace {

/// Roughnesses are equally spaced in log(α + kAlphaOffset): below the offset a lobe's image in its own warp no longer
/// depends on α.
constexpr int kRoughnesses = 32;
constexpr double kAlphaOffset = 0.02;
constexpr double kLeastTabulatedAlpha = 2e-4;
const double kFirstLog = std::log(kLeastTabulatedAlpha + kAlphaOffset);
const double kLogStep = (std::log(1 + kAlphaOffset) - kFirstLog) / (kRoughnesses - 1);

/// The table of one roughness, fitted when a shape first needs it.
const FitTable& tabulated(Fresnel fresnel, int roughness) {
    struct Entry {
        std::once_flag once;
        std::optional<FitTable> table;
    };
    static std::array<std::array<Entry, kRoughnesses>, 2> entries;
    Entry& entry = entries[fresnel == Fresnel::one ? 0 : 1][static_cast<std::size_t>(roughness)];
    std::call_once(entry.once, [&] {
        const double alpha = std::exp(kFirstLog + kLogStep * roughness) - kAlphaOffset;
        entry.table.emplace(fit_table(GgxShape{alpha, fresnel}, kWarpedOrders));
    });
    return *entry.table;
}

}  // namespace

FitTable ggx_fit_table(const GgxShape& shape) {
    const double log_alpha = std::log(std::max(shape.alpha, kLeastTabulatedAlpha) + kAlphaOffset);
    const CubicStencil s((log_alpha - kFirstLog) / kLogStep, 0, kRoughnesses);
    FitTable sum(kWarpedOrders);
    for (int k = 0; k < 4; ++k) {
        const auto from = tabulated(shape.fresnel, s.first + k).values();
        std::transform(from.begin(), from.end(), sum.values().begin(), sum.values().begin(),
                       [w = s.weights[k]](float value, float total) { return total + w * value; });
    }
    return sum;
}

std::size_t prepare_ggx_table() {
    std::size_t bytes = 0;
    for (const Fresnel fresnel : {Fresnel::one, Fresnel::schlick}) {
        for (int i = 0; i < kRoughnesses; ++i) {
            bytes += tabulated(fresnel, i).values().size_bytes();
        }
    }
    return bytes;
}

}  // namespace shlight
