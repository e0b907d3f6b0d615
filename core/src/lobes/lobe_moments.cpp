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

/// Longest Gauss panel [rad]: it holds fewer than three waves of band 63, which sixteen points integrate to 1e-10.
constexpr double kLongestPanel = std::numbers::pi / 12;

/// A point near which a function varies over the length `scale`; far from it the length is one.
struct Feature {
    double position, scale;
};

/// Gauss panels over (from, to). The length of each is at most kLongestPanel, and at most half its distance from a
/// feature plus the feature's scale.
QuadratureRule graded_rule(double from, double to, const std::vector<Feature>& features, int panel_points) {
    QuadratureRule rule;
    const GaussRule& gauss = gauss_rule(panel_points);
    double start = from;
    while (start < to) {
        // The bound holds on the whole panel if it is evaluated at the end nearer to the feature.
        const auto allowed = [&](double x) {
            double length = kLongestPanel;
            for (const Feature& f : features) {
                length = std::min(length, f.scale + 0.7 * std::abs(x - f.position));
            }
            return length;
        };
        double length = allowed(start);
        length = std::min(length, 2 * allowed(start + length));
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

LobeRule lobe_rule(double width, double theta_o, int panel_points) {
    const double half_pi = std::numbers::pi / 2;
    // The lobe is α wide in the plane of incidence and α cosθ_o across; masking varies over α near the horizon.
    const double across = width * std::max(std::cos(theta_o), 0.05);
    return {graded_rule(0, half_pi, {{theta_o, width}, {half_pi, width}}, panel_points),
            graded_rule(0, std::numbers::pi, {{0.0, across / std::max(std::sin(theta_o), across)}}, panel_points)};
}

double least_grazing(double theta_o) {
    return std::min(theta_o, std::numbers::pi / 2 - 1e-6);  // the same in float
}

LobeMoments lobe_moments(const LobeShape& shape, double theta_o) {
    LobeMoments result{std::vector<double>(kCosineMax), 0.0};
    const LobeRule rule = lobe_rule(lobe_width(shape), theta_o, kPanelPoints);
    result.norm_squared = integrate_moments(shape, std::cos(theta_o), rule, result.moments);
    return result;
}

std::vector<LobeMoments> moments_of_all_views(const LobeShape& shape) {
    std::vector<LobeMoments> views(kViewNodes);
    // Isolated, because a thread that waits here must not start unrelated work that asks for this same lobe.
    tbb::this_task_arena::isolate([&] {
        tbb::parallel_for(0, kViewNodes,
                          [&](int node) { views[node] = lobe_moments(shape, least_grazing(view_angle(node))); });
    });
    return views;
}

}  // namespace shlight
