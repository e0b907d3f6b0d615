// SPDX-License-Identifier: MIT
//
// Constants and functions of rough diffuse lobes that scalar code and lanes share.
#pragma once

namespace shlight {

/// α² ÷ tan² of a bump's tilt, α being the roughness of the bump's GGX shadowing (Estevez, Lecocq & Stein 2019).
inline constexpr double kBumpShare = 0.125;
/// Cosine below which oren_nayar_loss() is the cosine itself.
inline constexpr double kGrazingLoss = 1e-6;

/// π/2 - 2/3 - G(cosine), G of Fujii's Oren–Nayar model.
double oren_nayar_loss(double cosine);

}  // namespace shlight
