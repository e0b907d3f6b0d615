// SPDX-License-Identifier: MIT
#include "kernels/arc_rows.h"

#include <numeric>

namespace shlight {
namespace {

/// 0 if even the largest rule errs by more.
int points_for(double kappa, double tolerance) {
    const double square = kappa * kappa;
    double error = 2 * square * kGaussErrorGrowth[0];
    for (int k = 1; k < kMaxGaussPoints; ++k) {
        if (error <= tolerance) {
            return k;
        }
        error *= square * kGaussErrorGrowth[static_cast<std::size_t>(k)];
    }
    return 0;
}

}  // namespace

Division divided(double kappa, double tolerance) {
    // The longest arc, a whole circle at the highest order, takes eight pieces.
    for (int pieces = 1; pieces < 8; ++pieces) {
        const int points = points_for(kappa / pieces, tolerance);
        if (points > 0) {
            return {pieces, points};
        }
    }
    return {8, kMaxGaussPoints};
}

ArcOrder::ArcOrder(const RowList<std::uint8_t>& points) : index_(points.size()) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        ++start_[points[i] + 1U];
    }
    std::partial_sum(start_.begin(), start_.end(), start_.begin());
    auto next = start_;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        index_[next[points[i]]++] = i;
    }
}

}  // namespace shlight
