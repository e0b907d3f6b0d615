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

/// Integrates by a product rule in θ and φ whose panels shrink towards the lobe's peak and towards the horizon.
LobeMoments lobe_moments(const LobeShape& shape, double theta_o);
/// lobe_moments() at all views of view_grid.h, in parallel.
std::vector<LobeMoments> moments_of_all_views(const LobeShape& shape);

}  // namespace shlight
