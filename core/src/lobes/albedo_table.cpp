// SPDX-License-Identifier: MIT
#include "lobes/albedo_table.h"

#include <algorithm>
#include <cmath>

#include "base/recent_values.h"

namespace shlight {
namespace {

constexpr std::size_t kSteps = 25;
/// Views with a smaller cosθ_o get the albedo at this cosine.
constexpr double kGrazing = 0.01;
constexpr std::size_t kMostTables = 64;

double step(std::size_t i) {
    return static_cast<double>(i) / (kSteps - 1);
}

/// The table interval that contains a share 0 … 1 of all steps: its first step, and the position within it, 0 … 1.
struct Interval {
    std::size_t first;
    double rest;

    explicit Interval(double share) {
        const double place = std::max(0.0, std::min(1.0, share)) * (kSteps - 1);
        first = std::min(static_cast<std::size_t>(place), kSteps - 2);
        rest = place - static_cast<double>(first);
    }
};

}  // namespace

AlbedoTable::AlbedoTable(const LobeShape& shape) : widths_(is_glossy(shape) ? kSteps : 1) {
    for (std::size_t i = 0; i < widths_; ++i) {
        const LobeShape tabulated = with_width(shape, step(i) * step(i));
        for (std::size_t k = 0; k < kSteps; ++k) {
            values_.push_back(static_cast<float>(lobe_albedo(tabulated, std::max(step(k), kGrazing))));
        }
    }
}

double AlbedoTable::albedo(double width, double cos_theta_o) const {
    const Interval view(cos_theta_o);
    const auto of_row = [&](std::size_t row) {
        const float* nodes = &values_[row * kSteps + view.first];
        return (1 - view.rest) * double{nodes[0]} + view.rest * double{nodes[1]};
    };
    if (widths_ == 1) {
        return of_row(0);
    }
    const Interval row(std::sqrt(width));
    return (1 - row.rest) * of_row(row.first) + row.rest * of_row(row.first + 1);
}

std::shared_ptr<const AlbedoTable> albedo_table(const LobeShape& shape) {
    static RecentValues<LobeShape, AlbedoTable> known(kMostTables);
    const LobeShape of_any_width = with_width(shape, 0);
    return known.get(of_any_width, [&] { return std::make_shared<const AlbedoTable>(of_any_width); });
}

}  // namespace shlight
