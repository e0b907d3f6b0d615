// SPDX-License-Identifier: MIT
//
// Integrals of a lobe along an arc of a light's outline, which are what the light's radiance changes by where the arc
// moves: the normal velocity of any circle that stays a circle is a linear function of 1, cos ψ and sin ψ.
#pragma once

#include "lobes/boundary_kernel.h"
#include "regions/arcs.h"

namespace shlight {

/// ∫ f·cos (1, cos ψ, sin ψ) dψ, ψ being the angle from the arc's middle. weights: what an error of each counts; the
/// sums err by about 1e-8 of the largest weighted one.
/// Precondition: no mirror; the arc lies above the horizon.
ArcDensity arc_sums(const LobeShape& shape, double cos_theta_o, const Arc<double>& arc, const ArcDensity& weights);

}  // namespace shlight
