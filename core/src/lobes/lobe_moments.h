// SPDX-License-Identifier: MIT
#pragma once

#include <numbers>
#include <vector>

#include "shlight/lobe_shape.h"

namespace shlight {

/// Integrals of one lobe at one view angle over the upper hemisphere.
struct LobeMoments {
    std::vector<double> moments;  ///< ∫ f·cos Y_lm dω for m ≥ 0 and l < 64, cosine_index layout
    double norm_squared;          ///< ∫ (f·cos)² dω
};

struct QuadratureRule {
    std::vector<double> nodes, weights;
};

/// How long the Gauss panels of a rule may be.
struct PanelLengths {
    double longest;     ///< [rad]
    double at_feature;  ///< in units of the length over which a lobe varies there
    double growth;      ///< by so much times the distance from a feature
};
/// Three waves of band 63, which sixteen points integrate to 1e-10.
inline constexpr PanelLengths kFinePanels = {std::numbers::pi / 12, 1, 0.7};

/// A product rule over the upper hemisphere whose panels shrink towards a lobe's peak and towards the horizon.
struct LobeRule {
    QuadratureRule theta;  ///< 0 … π/2, without the factor sinθ
    QuadratureRule phi;    ///< 0 … π, from the mirror direction to either side
};
/// width: lobe_width(); panel_points: Gauss points of each panel.
LobeRule lobe_rule(double width, double theta_o, int panel_points, const PanelLengths& lengths = kFinePanels);

/// A view that is tabulated in the place of one at the horizon, where a lobe is only defined as a limit.
double least_grazing(double theta_o);

/// Integrates by lobe_rule().
LobeMoments lobe_moments(const LobeShape& shape, double theta_o, const PanelLengths& lengths = kFinePanels);
/// lobe_moments() at all views of view_grid.h, in parallel.
std::vector<LobeMoments> moments_of_all_views(const LobeShape& shape, const PanelLengths& lengths = kFinePanels);

}  // namespace shlight
