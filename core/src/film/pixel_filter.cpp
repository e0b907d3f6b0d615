// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numbers>

#include "shlight/render.h"

namespace shlight {
namespace {

constexpr double kPi = std::numbers::pi;

/// Coefficients of the four-term window with the lowest side lobes (Blackman and Harris 1978).
constexpr double kA0 = 0.35875;
constexpr double kA1 = 0.48829;
constexpr double kA2 = 0.14128;
constexpr double kA3 = 0.01168;

/// Integral of a filter on its support -1 … 1 from 0 to x ≥ 0, up to a factor.
double integral(PixelFilter::Kind kind, double x) {
    switch (kind) {
        case PixelFilter::Kind::box:
            return x;
        case PixelFilter::Kind::gaussian:
            // exp(-8 (v / width)²) on |v| < 1.5 width.
            return std::erf(std::sqrt(8.0) * 1.5 * x);
        case PixelFilter::Kind::blackman_harris:
            return kA0 * x + kA1 * std::sin(kPi * x) / kPi + kA2 * std::sin(2 * kPi * x) / (2 * kPi) +
                   kA3 * std::sin(3 * kPi * x) / (3 * kPi);
    }
    return x;
}

double half_support(const PixelFilter& filter) {
    switch (filter.kind) {
        case PixelFilter::Kind::box:
            return 0.5;
        case PixelFilter::Kind::gaussian:
            return 1.5 * filter.width;
        case PixelFilter::Kind::blackman_harris:
            return filter.width;
    }
    return 0.5;
}

/// The x up to which the integral is a share of that of one side.
double inverse(PixelFilter::Kind kind, double share) {
    const double wanted = share * integral(kind, 1.0);
    double low = 0;
    double high = 1;
    for (int bit = 0; bit < 40; ++bit) {
        const double middle = 0.5 * (low + high);
        (integral(kind, middle) < wanted ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

/// Number of steps in Cycles' table of the inverse, which is linear between them. The last step shows: it covers the
/// whole rim of the filter, which holds a thousandth of the light next to bright edges.
constexpr double kSteps = 511;

}  // namespace

double PixelFilter::place(double share) const {
    if (kind == Kind::box) {
        return share - 0.5;
    }
    const double steps = std::abs(2 * share - 1) * kSteps;
    const double step = std::min(std::floor(steps), kSteps - 1);
    const double near = inverse(kind, step / kSteps);
    const double far = step + 1 < kSteps ? inverse(kind, (step + 1) / kSteps) : 1.0;
    return std::copysign(near + (steps - step) * (far - near), share - 0.5) * half_support(*this);
}

}  // namespace shlight
