// SPDX-License-Identifier: MIT
//
// Caps that are small beside a lobe: which rule they take, and the integral by it.
#pragma once

#include <cstdint>
#include <span>

#include "kernels/cap_shading.h"
#include "shlight/lobe_shape.h"

namespace shlight {

/// ω_o = (x, 0, z) for each view.
struct ViewArrays {
    const double *x, *z;
    bool shared;  ///< there is one
};

/// What becomes of a cap, if not the number of a rule: it is large or cut by the horizon, or below the horizon.
inline constexpr std::uint8_t kNoCapRule = 0;
inline constexpr std::uint8_t kCapHidden = 255;

/// The smallest rule for each circle that keeps within its view's tolerance, absolute in units of the lobe's albedo and
/// relative to the light's own value. Circle i is seen by view view_of[i].
/// Rules: 1, 4, 7, 24 points. Precondition: shape.alpha > 0.
void choose_cap_rules(const GgxShape& shape, const CircleArrays& circles, const ViewArrays& views,
                      const float* tolerances, std::span<const std::uint32_t> view_of, std::span<std::uint8_t> rules);

/// values[i] = ∫ f·cos over circle circle_of[i], above the horizon, seen by view view_of[i], by one rule.
void integrate_caps(const GgxShape& shape, const CircleArrays& circles, std::span<const std::uint32_t> circle_of,
                    const ViewArrays& views, std::span<const std::uint32_t> view_of, int rule, std::span<float> values);

/// Points of a rule.
int cap_rule_points(int rule);

}  // namespace shlight
