// SPDX-License-Identifier: MIT
//
// Polygons that are small beside a lobe: their integrals by a rule of points on each of the triangles from the first
// vertex.
#pragma once

#include <cstdint>
#include <span>

#include "regions/cap_kernels.h"
#include "shlight/lobe_shape.h"
#include "shlight/types.h"

namespace shlight {

/// values[i] = ∫ f·cos over polygon polygon_of[i], clipped by the horizon, seen by view view_of[i], by one of the rules
/// that choose_polygon_rules() chooses from. vertices: vertex_count of each polygon, in either winding; parameters: of
/// the shape at each view, in the place of its own.
void integrate_polygons(const LobeShape& shape, const float* parameters, std::span<const Vec3d> vertices,
                        int vertex_count, std::span<const std::uint32_t> polygon_of, const ViewArrays& views,
                        std::span<const std::uint32_t> view_of, int rule, std::span<float> values);

/// Points of a rule on a polygon that the horizon does not cut.
int polygon_rule_points(int rule, int vertex_count);

}  // namespace shlight
