// SPDX-License-Identifier: MIT
#include "regions/arcs.h"

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

}  // namespace shlight
