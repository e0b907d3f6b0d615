// SPDX-License-Identifier: MIT
#include "lobes/lobe_moments.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lobes/moments_kernel.h"
#include "lobes/view_grid.h"
#include "math/gauss_legendre.h"

namespace shlight {
namespace {

constexpr int kPanelPoints = 16;
static_assert(kPanelPoints % kMomentLanes == 0);

/// A point near which a function varies over the length `scale`; far from it the length is one.
struct Feature {
    double position, scale;

    /// The length of a panel from x on whose end nearer to the feature has the distance d: scale · at_feature +
    /// growth · d.
    double allowed(double x, const PanelLengths& lengths) const {
        const double length = scale * lengths.at_feature + lengths.growth * std::abs(x - position);
        return x < position ? length / (1 + lengths.growth) : length;
    }
};

/// Gauss panels over (from, to), as long as all features allow.
QuadratureRule graded_rule(double from, double to, const std::vector<Feature>& features, int panel_points,
                           const PanelLengths& lengths) {
    QuadratureRule rule;
    const GaussRule& gauss = gauss_rule(panel_points);
    double start = from;
    while (start < to) {
        double length = lengths.longest;
        for (const Feature& feature : features) {
            length = std::min(length, feature.allowed(start, lengths));
        }
        if (to - start < 1.2 * length) {
            length = to - start;
        }
        for (std::size_t i = 0; i < gauss.nodes.size(); ++i) {
            rule.nodes.push_back(start + length * gauss.nodes[i]);
            rule.weights.push_back(length * gauss.weights[i]);
        }
        start += length;
    }
    return rule;
}

}  // namespace

LobeRule lobe_rule(double width, double theta_o, int panel_points, const PanelLengths& lengths) {
    const double half_pi = std::numbers::pi / 2;
    // The lobe is α wide in the plane of incidence and α cosθ_o across; masking varies over α near the horizon.
    const double across = width * std::max(std::cos(theta_o), 0.05);
    const Feature mirror = {0.0, across / std::max(std::sin(theta_o), across)};
    return {graded_rule(0, half_pi, {{theta_o, width}, {half_pi, width}}, panel_points, lengths),
            graded_rule(0, std::numbers::pi, {mirror}, panel_points, lengths)};
}

double least_grazing(double theta_o) {
    return std::min(theta_o, std::numbers::pi / 2 - 1e-6);  // the same in float
}

LobeMoments lobe_moments(const LobeShape& shape, double theta_o, const PanelLengths& lengths) {
    LobeMoments result{std::vector<double>(kCosineMax), 0.0};
    const LobeRule rule = lobe_rule(lobe_width(shape), theta_o, kPanelPoints, lengths);
    result.norm_squared = integrate_moments(shape, std::cos(theta_o), rule, result.moments);
    return result;
}

std::vector<LobeMoments> moments_of_all_views(const LobeShape& shape, const PanelLengths& lengths) {
    std::vector<LobeMoments> views(kViewNodes);
    // Isolated, because a thread that waits here must not start unrelated work that asks for this same lobe.
    tbb::this_task_arena::isolate([&] {
        tbb::parallel_for(0, kViewNodes, [&](int node) {
            views[node] = lobe_moments(shape, least_grazing(view_angle(node)), lengths);
        });
    });
    return views;
}

}  // namespace shlight
