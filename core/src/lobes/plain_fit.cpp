// SPDX-License-Identifier: MIT
#include "shlight/plain_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "base/recent_values.h"
#include "lobes/lambert.h"
#include "lobes/lobe_moments.h"
#include "lobes/normal_equations.h"
#include "lobes/view_grid.h"
#include "math/gauss_legendre.h"
#include "math/legendre.h"
#include "shlight/lobe_table.h"

namespace shlight {
namespace {

/// The fits of order 64 over the upper hemisphere. Their Gram matrix is exact with 64 Gauss points (degree ≤ 126).
const NormalEquations& hemisphere() {
    static const NormalEquations equations = [] {
        const GaussRule& rule = gauss_rule(kMaxGaussPoints);
        return NormalEquations(HeightBasis(rule.nodes, kMaxOrder), rule.weights);
    }();
    return equations;
}

}  // namespace

PlainFit::PlainFit(const LobeShape& shape) {
    if (const auto* table = std::get_if<TableShape>(&shape)) {
        table_ = *table;
    }
    if (std::holds_alternative<LambertShape>(shape)) {
        return;
    }
    for (LobeMoments& lobe : moments_of_all_views(shape)) {
        hemisphere().reduce(lobe.moments);
        reduced_.insert(reduced_.end(), lobe.moments.begin(), lobe.moments.end());
        norms_.push_back(std::sqrt(lobe.norm_squared));
    }
}

double PlainFit::norm(double cos_theta_o) const {
    if (norms_.empty()) {
        return std::sqrt(2 / (3 * std::numbers::pi));
    }
    const ViewInterval view(cos_theta_o);
    return (1 - view.t) * norms_[view.low] + view.t * norms_[view.low + 1];
}

double PlainFit::residual(double cos_theta_o, int order) const {
    check_order(order);
    if (norms_.empty()) {
        return lambert_error(order);
    }
    const ViewInterval view(cos_theta_o);
    const double lacking = table_.table ? table_.table->sampling_error(cos_theta_o, table_.channel) : 0.0;
    return (1 - view.t) * residual_at(view.low, order) + view.t * residual_at(view.low + 1, order) + lacking;
}

double PlainFit::residual_at(std::size_t node, int order) const {
    const double norm = norms_[node];
    const auto reduced = std::span(reduced_).subspan(node * kCosineMax, kCosineMax);
    return norm > 0 ? std::sqrt(hemisphere().squared_error(reduced, order, norm * norm)) / norm : 0.0;
}

void PlainFit::coefficients(double cos_theta_o, int order, float* cosine_terms) const {
    check_order(order);
    if (norms_.empty()) {
        fit_lambert(order, cosine_terms);
        return;
    }
    // The fit is linear in the lobe, so that interpolation between views may come before the solution.
    std::array<double, kCosineMax> reduced, terms;
    interpolate_terms(std::span<const double>(reduced_), static_cast<float>(cos_theta_o), order, reduced.data());
    hemisphere().solve(reduced, order, terms);
    std::transform(terms.begin(), terms.begin() + cosine_count(order), cosine_terms,
                   [](double term) { return static_cast<float>(term); });
}

std::shared_ptr<const PlainFit> plain_fit(const LobeShape& shape) {
    // A fit takes some 2 MB. They are kept because a scene that is exported anew for every picture asks again.
    constexpr std::size_t kRecentFits = 16;
    static RecentValues<LobeShape, PlainFit> recent(kRecentFits);
    return recent.get(shape, [&] { return std::make_shared<const PlainFit>(shape); });
}

}  // namespace shlight
