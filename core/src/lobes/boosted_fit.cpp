// SPDX-License-Identifier: MIT
#include "shlight/boosted_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/recent_values.h"
#include "lobes/fit_table.h"
#include "lobes/lambert.h"
#include "math/legendre.h"

namespace shlight {
namespace {

FitTable make_table(const LobeShape& shape, int order) {
    if (order != 0) {
        return fit_table(shape, std::array{order});
    }
    const auto* ggx = std::get_if<GgxShape>(&shape);
    return ggx != nullptr && ggx->fresnel != Fresnel::dielectric ? fit_grid(*ggx, 0)->interpolated(ggx->alpha)
                                                                 : fit_table(shape, kBoostedOrders);
}

}  // namespace

Boost lobe_boost(const LobeShape& shape, double cos_theta_o) {
    if (!is_glossy(shape)) {
        return {};
    }
    // Eq. 37 of docs/theory.md, found by minimising the residual of order 12: 5 α cos^0.4 θ_o for narrow lobes,
    // saturating for wide ones, which gain nothing.
    const double cosine = std::clamp(cos_theta_o, kLeastFittedCosine, 1.0);
    const double width = 5 * lobe_width(shape) * std::pow(cosine, 0.4);
    return {std::acos(cosine), width / std::pow(1 + width * std::sqrt(width), 2.0 / 3)};
}

BoostedFit::BoostedFit(const LobeShape& shape, int order)
    : shape_(shape), order_(order == 0 ? kLambertOrder : std::min(order, kLambertOrder)) {
    if (order != 0) {
        check_order(order);
    }
    if (!std::holds_alternative<LambertShape>(shape)) {
        table_ = std::make_shared<const FitTable>(make_table(shape, order));
    }
}

std::vector<int> BoostedFit::orders() const {
    if (table_) {
        return {table_->orders().begin(), table_->orders().end()};
    }
    return {order_};
}

double BoostedFit::albedo(double cos_theta_o) const {
    float albedo = 1;
    if (table_) {
        table_->look_up(cos_theta_o, FitTable::kAlbedo, {&albedo, 1});
    }
    return albedo;
}

void BoostedFit::coefficients(double cos_theta_o, int order, float* cosine_terms) const {
    if (table_) {
        table_->look_up(cos_theta_o, table_->terms(table_->which(order)),
                        {cosine_terms, static_cast<std::size_t>(cosine_count(order))});
        return;
    }
    fit_lambert(order, cosine_terms);
}

std::shared_ptr<const BoostedFit> boosted_fit(const LobeShape& shape, int order) {
    constexpr std::size_t kRecentFits = 64;
    static RecentValues<std::pair<LobeShape, int>, BoostedFit> recent(kRecentFits);
    return recent.get({shape, order}, [&] { return std::make_shared<const BoostedFit>(shape, order); });
}

}  // namespace shlight
