// SPDX-License-Identifier: MIT
#include "lobes/sh_projection.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <numbers>
#include <numeric>

#include "base/recent_values.h"
#include "lobes/lambert.h"
#include "lobes/lobe_moments.h"
#include "lobes/view_grid.h"
#include "math/legendre.h"

namespace shlight {
namespace {

/// Number of lobes that are kept, some 1 MB each, and of anisotropic ones of up to 26 MB. A picture of roughness asks
/// for up to 37 widths of each Fresnel factor.
constexpr std::size_t kRecentLobes = 128, kRecentAnisotropicLobes = 12;
/// For moments within 1e-4 of a lobe's albedo, except for lobes at the horizon that are narrower than a hundredth of
/// it.
constexpr PanelLengths kPanels = {std::numbers::pi / 7, 2, 1.2};

}  // namespace

ShProjection::ShProjection(const LobeShape& shape) {
    if (std::holds_alternative<LambertShape>(shape)) {
        add_node({lambert_moments()}, 2 / (3 * std::numbers::pi));
    } else if (is_anisotropic(shape)) {
        const auto& own = std::get<TableShape>(shape);
        views_.emplace(*own.table);
        std::vector<FullMoments> nodes(views_->size());
        views_->for_each([&](std::size_t view) { nodes[view] = views_->moments(own, view, kMaxOrder); });
        for (const FullMoments& node : nodes) {
            add_node({node.cosines, node.sines}, node.norm_squared);
        }
    } else {
        for (const LobeMoments& node : moments_of_all_views(shape, kPanels)) {
            add_node({node.moments}, node.norm_squared);
        }
    }
}

void ShProjection::add_node(std::initializer_list<std::span<const double>> terms, double norm_squared) {
    std::array<double, kMaxOrder> sums{};
    for (const std::span<const double> some : terms) {
        std::transform(some.begin(), some.end(), std::back_inserter(terms_),
                       [](double term) { return static_cast<float>(term); });
        for (int l = 0; l < kMaxOrder; ++l) {
            for (int m = 0; m <= l; ++m) {
                sums[static_cast<std::size_t>(l)] += some[at(l, m)] * some[at(l, m)];
            }
        }
    }
    powers_.insert(powers_.end(), sums.begin(), sums.end());
    tails_.push_back(static_cast<float>(std::max(norm_squared - std::accumulate(sums.begin(), sums.end(), 0.0), 0.0)));
}

void ShProjection::coefficients(float cos_theta_o, float azimuth, bool sines, int order, float* terms) const {
    if (!views_) {
        interpolate_terms(std::span<const float>(terms_), cos_theta_o, order, terms);
        return;
    }
    views_->taps(double{cos_theta_o}, double{azimuth})
        .interpolate(terms_, 2 * kCosineMax, sines ? kCosineMax : 0, static_cast<std::size_t>(cosine_count(order)),
                     terms);
}

RowTaps ShProjection::nodes(double cos_theta_o, double azimuth) const {
    if (views_) {
        return views_->taps(cos_theta_o, azimuth);
    }
    const std::size_t low = node_count() > 1 ? ViewInterval(cos_theta_o).low : 0;
    return {{low, low + (node_count() > 1 ? 1 : 0)}, {}, 2};
}

std::shared_ptr<const ShProjection> sh_projection(const LobeShape& shape) {
    static RecentValues<LobeShape, ShProjection> recent(kRecentLobes), recent_anisotropic(kRecentAnisotropicLobes);
    return (is_anisotropic(shape) ? recent_anisotropic : recent).get(shape, [&] {
        return std::make_shared<const ShProjection>(shape);
    });
}

}  // namespace shlight
