// SPDX-License-Identifier: MIT
#include "outline_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "elliptic.h"

namespace shlight {
namespace {

/// Beyond this the outline is a circle as far as the bound can tell.
constexpr double kHighest = 7;
constexpr int kMostPieces = 64;

}  // namespace

OutlinePoints::OutlinePoints(double sin_long, double complement) {
    const double k = std::sqrt((1 - complement) * (1 + complement));
    const EllipticFunctions<double> across(std::max(k, 1e-5));
    const double top = std::min(across.quarter_period(), kHighest);
    constexpr std::array kShares = {0.15, 0.3, 0.45, 0.6, 0.72, 0.83, 0.92, 0.97};
    for (std::size_t i = 0; i < heights_.size(); ++i) {
        const double s = kShares[i] * top;
        const auto f = across.at(s);
        heights_[i] = {s, std::asinh(sin_long * f.sn / f.cn)};
    }
}

Division OutlinePoints::closed(double quarter, double degree, double digits) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Height& h : heights_) {
        least = std::min(least, (degree * h.growth + digits) * 4 * quarter / (2 * std::numbers::pi * h.s));
    }
    const int points = static_cast<int>(least) + 2;
    const int pieces = (points + kMaxGaussPoints - 1) / kMaxGaussPoints;
    return {pieces, (points + pieces - 1) / pieces};
}

Division OutlinePoints::open(double half, double degree, double digits) const {
    return open(half, degree, digits, std::numeric_limits<double>::infinity());
}

Division OutlinePoints::open(double half, double degree, double digits, double pole) const {
    Division best = {kMostPieces, kMaxGaussPoints};
    for (int pieces = 1; pieces <= kMostPieces; ++pieces) {
        const double h = half / pieces;
        double least = std::numeric_limits<double>::infinity();
        for (const Height& height : heights_) {
            if (height.s < pole) {
                least = std::min(least, (degree * height.growth + digits) / (2 * std::asinh(height.s / h)));
            }
        }
        const int points = least < kMaxGaussPoints ? static_cast<int>(least) + 1 : kMaxGaussPoints + 1;
        if (points <= kMaxGaussPoints && pieces * points < best.pieces * best.points) {
            best = {pieces, points};
        } else if (best.pieces < pieces && best.points < kMaxGaussPoints / 2) {
            break;
        }
    }
    return best;
}

/// In the sine of the angle, which has its branch points at ±1. An angle of imaginary part s has grown by e^s a degree.
int points_across(double half, double degree, double digits) {
    const double reach = std::sin(half);
    const double room = std::cos(half);
    double least = kMaxGaussPoints;
    for (const double share : {0.1, 0.2, 0.4, 0.6, 0.8, 0.95}) {
        const double s = share * room;
        least = std::min(least, (degree * std::asinh(s) + digits) / (2 * std::asinh(s / reach)));
    }
    return std::clamp(static_cast<int>(least) + 1, 1, kMaxGaussPoints);
}

}  // namespace shlight
