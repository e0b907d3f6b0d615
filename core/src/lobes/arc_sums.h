// SPDX-License-Identifier: MIT
//
// Integrals of a lobe along an arc of a light's outline, which are what the light's radiance changes by where the arc
// moves: the normal velocity of any circle that stays a circle is a linear function of 1, cos ψ and sin ψ.
#pragma once

#include <array>
#include <span>

#include "lobes/boundary_kernel.h"
#include "regions/arcs.h"

namespace shlight {

/// ∫ f·cos (1, cos ψ, sin ψ) dψ of R, of G and of B, ψ being the angle from the arc's middle.
using ArcSums = ArcDensity;

/// The sums of all lobes, which have one lobe_width(). weights: what an error of each of the three counts; the sums err
/// by about 1e-8 of the largest weighted one.
/// Precondition: no mirrors; the arc lies above the horizon.
ArcSums arc_sums(std::span<const WeightedLobe> lobes, double cos_theta_o, const Arc<double>& arc,
                 const std::array<double, 3>& weights);

}  // namespace shlight
