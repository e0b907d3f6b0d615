// SPDX-License-Identifier: MIT
#include "lobes/sh_projection.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <span>

#include "base/recent_values.h"
#include "lobes/lambert.h"
#include "lobes/lobe_moments.h"
#include "lobes/view_grid.h"
#include "math/legendre.h"

namespace shlight {
namespace {

/// Number of lobes that are kept, some 1 MB each.
constexpr std::size_t kRecentLobes = 32;

}  // namespace

ShProjection::ShProjection(const LobeShape& shape) {
    if (std::holds_alternative<LambertShape>(shape)) {
        add_node(lambert_moments().data(), 2 / (3 * std::numbers::pi));
        return;
    }
    for (const LobeMoments& node : moments_of_all_views(shape)) {
        add_node(node.moments.data(), node.norm_squared);
    }
}

void ShProjection::add_node(const double* cosine_terms, double norm_squared) {
    std::transform(cosine_terms, cosine_terms + kCosineMax, std::back_inserter(terms_),
                   [](double term) { return static_cast<float>(term); });
    double left = norm_squared;
    for (int l = 0; l < kMaxOrder; ++l) {
        double power = 0;
        for (int m = 0; m <= l; ++m) {
            power += cosine_terms[at(l, m)] * cosine_terms[at(l, m)];
        }
        powers_.push_back(static_cast<float>(power));
        left -= power;
    }
    tails_.push_back(static_cast<float>(std::max(left, 0.0)));
}

void ShProjection::coefficients(float cos_theta_o, int order, float* cosine_terms) const {
    interpolate_terms(std::span<const float>(terms_), cos_theta_o, order, cosine_terms);
}

std::shared_ptr<const ShProjection> sh_projection(const LobeShape& shape) {
    static RecentValues<LobeShape, ShProjection> recent(kRecentLobes);
    return recent.get(shape, [&] { return std::make_shared<const ShProjection>(shape); });
}

}  // namespace shlight
