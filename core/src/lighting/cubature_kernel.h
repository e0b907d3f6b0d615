// SPDX-License-Identifier: MIT
//
// Lights that are small beside a lobe: which rule of cubature they take, and caps' integrals by it.
#pragma once

#include <cstdint>
#include <span>

#include "regions/cap_kernels.h"
#include "regions/polygon_kernels.h"
#include "shlight/lobe_shape.h"

namespace shlight {

/// Results other than the number of a rule: the light is large, or a cap that the horizon cuts (kNoRule), or it is
/// below the horizon (kHidden).
inline constexpr std::uint8_t kNoRule = 0;
inline constexpr std::uint8_t kHidden = 255;

/// The smallest rule for each light that keeps within its view's tolerance, absolute in units of the lobe's albedo and
/// relative to the light's own value. Light i is seen by view view_of[i].
/// Rules of caps: 1, 4, 7, 24 points; of polygons: 3, 7, 16, 25 points a triangle. widths: of the lobe at each view,
/// positive.
void choose_cap_rules(const float* widths, const CapArrays& circles, const ViewArrays& views, const float* tolerances,
                      std::span<const std::uint32_t> view_of, std::span<std::uint8_t> rules);
void choose_polygon_rules(const float* widths, const PolygonArrays& polygons, const ViewArrays& views,
                          const float* tolerances, std::span<const std::uint32_t> view_of,
                          std::span<std::uint8_t> rules);

/// values[i] = ∫ f·cos over circle circle_of[i], above the horizon, seen by view view_of[i], by one rule.
/// parameters: lobe_parameter() of the shape at each view, in the place of its own.
void integrate_caps(const LobeShape& shape, const float* parameters, const CapArrays& circles,
                    std::span<const std::uint32_t> circle_of, const ViewArrays& views,
                    std::span<const std::uint32_t> view_of, int rule, std::span<float> values);

/// Points of a rule of caps.
int cap_rule_points(int rule);

}  // namespace shlight
