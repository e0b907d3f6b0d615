// SPDX-License-Identifier: MIT
#include "shlight/lobe_fit.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <mutex>
#include <numbers>

#include "lobes/hemisphere_basis.h"
#include "lobes/lobe_moments.h"
#include "lobes/view_grid.h"
#include "math/legendre.h"

namespace shlight {
namespace {

/// Fits kept although nobody holds them, some 4 MB each: a scene that is exported anew for every picture asks again.
constexpr std::size_t kRecentFits = 16;

/// Linear interpolation is enough for what only steers a choice or varies slowly.
template <class Values>
double interpolated(double cos_theta_o, const Values& value_at) {
    const double position = std::acos(std::clamp(cos_theta_o, 0.0, 1.0)) * (kViewNodes - 1) * 2 / std::numbers::pi;
    const int low = std::clamp(static_cast<int>(position), 0, kViewNodes - 2);
    const double t = position - low;
    return (1 - t) * value_at(low) + t * value_at(low + 1);
}

/// Lambert in closed form: z/π is one harmonic, and order 1 can only be the mean 1/(2π).
std::vector<float> lambert_row(int order) {
    std::vector<float> row(static_cast<std::size_t>(cosine_count(order)), 0.0F);
    if (order == 1) {
        row[0] = static_cast<float>(std::sqrt(4 * std::numbers::pi) / (2 * std::numbers::pi));
    } else {
        row[at(1, 0)] = static_cast<float>(std::sqrt(4 * std::numbers::pi / 3) / std::numbers::pi);
    }
    return row;
}

}  // namespace

LobeTable::LobeTable(int order, std::vector<float> nodes) : order_(order), nodes_(std::move(nodes)) {}

void LobeTable::coefficients(float cos_theta_o, float* cosine_terms) const {
    const auto row = static_cast<std::size_t>(cosine_count(order_));
    if (nodes_.size() == row) {
        std::copy(nodes_.begin(), nodes_.end(), cosine_terms);
        return;
    }
    const ViewStencil s(cos_theta_o);
    const std::array<const float*, 4> rows = {&nodes_[s.nodes[0] * row], &nodes_[s.nodes[1] * row],
                                              &nodes_[s.nodes[2] * row], &nodes_[s.nodes[3] * row]};
    std::size_t i = 0;
    for (int l = 0; l < order_; ++l) {
        for (int m = 0; m <= l; ++m, ++i) {
            const auto& w = m % 2 == 0 ? s.even : s.odd;
            cosine_terms[i] = w[0] * rows[0][i] + w[1] * rows[1][i] + w[2] * rows[2][i] + w[3] * rows[3][i];
        }
    }
}

LobeFit::LobeFit(const LobeShape& shape) : shape_(shape) {
    if (!std::holds_alternative<LambertShape>(shape)) {
        fit_all_views();
    }
    for (std::size_t i = 0; i < kOrderLadder.size(); ++i) {
        ladder_[i] = std::make_shared<const LobeTable>(solve_table(kOrderLadder[i]));
    }
}

void LobeFit::fit_all_views() {
    const auto nodes = static_cast<std::size_t>(kViewNodes);
    reduced_.resize(nodes * kCosineMax);
    norms_.resize(nodes);
    albedos_.resize(nodes);
    residuals_.resize(nodes * kMaxOrder);
    const HemisphereBasis& basis = HemisphereBasis::get();
    const auto fit_view = [&](std::size_t node) {
        // At exactly grazing view a lobe is a limit; a view a microradian above it is the same to single precision.
        const double theta = std::min(view_angle(static_cast<int>(node)), std::numbers::pi / 2 - 1e-6);
        LobeMoments lobe = lobe_moments(shape_, theta);
        basis.reduce(lobe.moments);
        const auto errors = basis.squared_errors(lobe.moments, lobe.norm_squared);
        std::copy(lobe.moments.begin(), lobe.moments.end(), &reduced_[node * kCosineMax]);
        norms_[node] = std::sqrt(lobe.norm_squared);
        albedos_[node] = lobe.albedo;
        for (std::size_t n = 0; n < kMaxOrder; ++n) {
            residuals_[node * kMaxOrder + n] =
                static_cast<float>(lobe.norm_squared > 0 ? std::sqrt(errors[n] / lobe.norm_squared) : 0.0);
        }
    };
    // Isolated: a thread that waits here must not pick up unrelated work that may ask for this very fit.
    tbb::this_task_arena::isolate([&] { tbb::parallel_for(std::size_t{0}, nodes, fit_view); });
}

LobeTable LobeFit::solve_table(int order) const {
    check_order(order);
    if (reduced_.empty()) {
        return {order, lambert_row(order)};
    }
    const auto row = static_cast<std::size_t>(cosine_count(order));
    std::vector<float> table(kViewNodes * row);
    std::vector<double> solution(row);
    for (std::size_t node = 0; node < kViewNodes; ++node) {
        const std::span<const double> reduced(&reduced_[node * kCosineMax], kCosineMax);
        HemisphereBasis::get().solve(reduced, order, solution);
        std::transform(solution.begin(), solution.end(), &table[node * row],
                       [](double c) { return static_cast<float>(c); });
    }
    return {order, std::move(table)};
}

double LobeFit::albedo(double cos_theta_o) const {
    return albedos_.empty() ? 1.0 : interpolated(cos_theta_o, [&](int i) { return albedos_[i]; });
}

double LobeFit::norm(double cos_theta_o) const {
    return norms_.empty() ? std::sqrt(2 / (3 * std::numbers::pi))
                          : interpolated(cos_theta_o, [&](int i) { return norms_[i]; });
}

double LobeFit::residual(double cos_theta_o, int order) const {
    check_order(order);
    if (residuals_.empty()) {
        return order == 1 ? 0.5 : 0.0;  // of cosθ the mean explains three quarters of the square
    }
    return interpolated(cos_theta_o,
                        [&](int node) { return static_cast<double>(residuals_[node * kMaxOrder + order - 1]); });
}

std::shared_ptr<const LobeTable> LobeFit::table(int order) const {
    const auto* found = std::find(kOrderLadder.begin(), kOrderLadder.end(), order);
    if (found != kOrderLadder.end()) {
        return ladder_[found - kOrderLadder.begin()];
    }
    return std::make_shared<const LobeTable>(solve_table(order));
}

std::shared_ptr<const LobeFit> fitted(const LobeShape& shape) {
    static std::mutex mutex;
    static std::map<LobeShape, std::weak_ptr<const LobeFit>> fits;
    static std::deque<std::shared_ptr<const LobeFit>> recent;  // the last one asked for in front
    const std::scoped_lock lock(mutex);
    std::weak_ptr<const LobeFit>& slot = fits[shape];
    std::shared_ptr<const LobeFit> fit = slot.lock();
    if (!fit) {
        fit = std::make_shared<const LobeFit>(shape);
        slot = fit;
    }
    std::erase(recent, fit);
    recent.push_front(fit);
    if (recent.size() > kRecentFits) {
        recent.pop_back();
    }
    return fit;
}

}  // namespace shlight
