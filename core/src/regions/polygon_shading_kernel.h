// SPDX-License-Identifier: MIT
//
// Eq. 5 for many polygons at once: Σ f_lm L_lm without storing L.
#pragma once

#include <cstdint>
#include <span>

#include "shlight/types.h"
#include "simd/lobe_arrays.h"

namespace shlight {

/// values[i] = Σ f_lm L_lm of polygon polygon_of[i], clipped by the horizon, under the lobe at view view_of[i].
/// vertices: vertex_count for each polygon, planar, finite, in the shading frame, before any boost.
/// No value depends on what else is in the lists.
void shade_polygons(std::span<const Vec3d> vertices, int vertex_count, std::span<const std::uint32_t> polygon_of,
                    const LobeArrays& lobe, std::span<const std::uint32_t> view_of, std::span<float> values);

}  // namespace shlight
