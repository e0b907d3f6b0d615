// SPDX-License-Identifier: MIT
#pragma once

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

/// A product rule over the upper hemisphere whose panels shrink towards a lobe's peak and towards the horizon.
struct LobeRule {
    QuadratureRule theta;  ///< 0 … π/2, without the factor sinθ
    QuadratureRule phi;    ///< 0 … π, from the mirror direction to either side
};
/// width: lobe_width(); panel_points: Gauss points of each panel.
LobeRule lobe_rule(double width, double theta_o, int panel_points);

/// A view that is tabulated in the place of one at the horizon, where a lobe is only defined as a limit.
double least_grazing(double theta_o);

/// Integrates by lobe_rule().
LobeMoments lobe_moments(const LobeShape& shape, double theta_o);
/// lobe_moments() at all views of view_grid.h, in parallel.
std::vector<LobeMoments> moments_of_all_views(const LobeShape& shape);

}  // namespace shlight
