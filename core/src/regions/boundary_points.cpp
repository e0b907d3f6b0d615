// SPDX-License-Identifier: MIT
#include "regions/boundary_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "math/elliptic.h"

namespace shlight {
namespace {

/// Beyond this the boundary is a circle as far as the bound can tell.
constexpr double kHighest = 7;
constexpr int kMostPieces = 64;

constexpr std::size_t kHeights = 6;
struct StripHeight {
    double s, tangent;  ///< sc(s | k'²)
};
using HeightStrip = std::array<StripHeight, kHeights>;

HeightStrip strip_of(double complement) {
    const EllipticFunctions across(std::max(std::sqrt((1 - complement) * (1 + complement)), 1e-5));
    const double top = std::min(across.quarter_period(), kHighest);
    constexpr std::array<double, kHeights> kShares = {0.25, 0.45, 0.6, 0.75, 0.87, 0.95};
    HeightStrip strip;
    for (std::size_t i = 0; i < kHeights; ++i) {
        const auto f = across.at(kShares[i] * top);
        strip[i] = {kShares[i] * top, f.sn / f.cn};
    }
    return strip;
}

/// The strip of the next smaller k' in a table: it is lower, and at the same height sc is larger, so the bound holds.
const HeightStrip& strip_below(double complement) {
    constexpr int kRows = 256;
    static const std::vector<HeightStrip> strips = [] {
        std::vector<HeightStrip> made;
        for (int i = 0; i <= kRows; ++i) {
            const double distance = 1 - static_cast<double>(i) / kRows;
            made.push_back(strip_of(std::max(1 - distance * distance, 1e-9)));
        }
        return made;
    }();
    return strips[static_cast<std::size_t>(kRows * (1 - std::sqrt(1 - complement)))];
}

}  // namespace

BoundaryPoints::BoundaryPoints(double sin_long, double complement) {
    const HeightStrip& strip = strip_below(std::min(1.0, complement));
    for (std::size_t i = 0; i < heights_.size(); ++i) {
        heights_[i] = {strip[i].s, std::asinh(sin_long * strip[i].tangent)};
    }
}

Division BoundaryPoints::closed(double quarter, double degree, double digits) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Height& h : heights_) {
        least = std::min(least, (degree * h.growth + digits) * 4 * quarter / (2 * std::numbers::pi * h.s));
    }
    const int points = static_cast<int>(std::min<double>(kMostPieces * kMaxGaussPoints, least)) + 2;
    const int pieces = (points + kMaxGaussPoints - 1) / kMaxGaussPoints;
    return {pieces, (points + pieces - 1) / pieces};
}

Division BoundaryPoints::open(double half, double degree, double digits) const {
    return open(half, degree, digits, std::numeric_limits<double>::infinity());
}

Division BoundaryPoints::open(double half, double degree, double digits, double pole) const {
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
        }
        if (best.points < kMaxGaussPoints / 2) {  // more pieces would take more points
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

double digits_for(const SphericalEllipse& ellipse, int order, double epsilon) {
    // Double cannot resolve more than this.
    constexpr double kLeastTolerance = 1e-19;
    const double allowed = 0.25 * order * epsilon * ellipse.least_solid_angle() / ellipse.boundary();
    return -std::log(std::max(allowed, kLeastTolerance));
}

}  // namespace shlight
