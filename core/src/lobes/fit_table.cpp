// SPDX-License-Identifier: MIT
#include "lobes/fit_table.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "lobes/view_kernel.h"
#include "shlight/boosted_fit.h"

namespace shlight {
namespace {

/// artanh(sinθ_o) of the most grazing view that is fitted.
const double kFarthestView = std::acosh(1 / kLeastFittedCosine);

}  // namespace

double boosted_view_cosine(int view) {
    return 1 / std::cosh(kFarthestView * view / (kBoostedViews - 1));
}

FitTable::FitTable(std::span<const int> orders) : orders_(orders.begin(), orders.end()), row_size_(kHeadWidth) {
    for (std::size_t i = 0; i < orders_.size(); ++i) {
        first_.push_back(row_size_);
        row_size_ += width(i);
    }
    values_.grow((kBoostedViews + 1) * row_size_);
}

std::size_t FitTable::which(int order) const {
    return static_cast<std::size_t>(std::find(orders_.begin(), orders_.end(), order) - orders_.begin());
}

void FitTable::look_up(double cos_theta_o, std::size_t column, std::span<float> out) const {
    std::array<double, kViewLanes> cosine;
    cosine.fill(cos_theta_o);
    std::array<double, kViewLanes> sine, fitted_sine, fitted_cosine;
    std::array<float, kViewLanes> log_cosine;
    std::array<std::uint32_t, kViewLanes> row;
    std::array<float, 4 * kViewLanes> weights;
    find_views(cosine.data(), 1,
               {sine.data(), fitted_sine.data(), fitted_cosine.data(), log_cosine.data(), row.data(), weights.data()});
    constexpr std::uint32_t kFirst = 0;
    AlignedFloats padded;
    padded.grow(out.size());
    const float* const table = values().data() + column;
    interpolate_views({1, &table, nullptr}, row_size_, AlignedFloats::padded(out.size()), row.data(), weights.data(),
                      {&kFirst, 1}, padded.data(), 0);
    std::copy_n(padded.data(), out.size(), out.begin());
}

FitTable fit_table(const LobeShape& shape, std::span<const int> orders) {
    FitTable table(orders);
    // Isolated, because a thread that waits here must not start unrelated work that asks for this same fit.
    tbb::this_task_arena::isolate(
        [&] { tbb::parallel_for(0, kBoostedViews, [&](int view) { fit_row(shape, view, table); }); });
    const auto beyond = table.row(-1);
    std::copy_n(table.row(1).begin(), beyond.size(), beyond.begin());
    for (std::size_t i = 0; i < orders.size(); ++i) {
        for (int l = 0; l < orders[i]; ++l) {
            for (int m = 1; m <= l; m += 2) {
                beyond[table.terms(i) + static_cast<std::size_t>(cosine_index(l, m))] *= -1;
            }
        }
    }
    return table;
}

}  // namespace shlight
