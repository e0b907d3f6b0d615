// SPDX-License-Identifier: MIT
//
// What scalar code and lanes share of diffuse lobes that are not Lambert's.
#pragma once

namespace shlight {

/// Of tan² of a bump's tilt: the α² of its shadow (Estevez, Lecocq & Stein 2019).
inline constexpr double kBumpShare = 0.125;
/// Below this cosine the loss is the cosine itself.
inline constexpr double kGrazingLoss = 1e-6;

/// π/2 - 2/3 - G(cosine), G of Fujii's Oren–Nayar model.
double oren_nayar_loss(double cosine);

}  // namespace shlight
