// SPDX-License-Identifier: MIT
//
// Sums of slices of constant z along an outline (quad_truth.h). Included by the quad_*.cpp files only.
#pragma once

#include <vector>

#include "quad_math.h"

namespace shlight::truth {

/// Adds the slice integrands of all order² coefficients but the first at one point of an outline; dz and area = x dy -
/// y dx carry the weight.
void add_arc_point(const OrderTables& tables, const Vec3q& p, quad dz, quad area, std::vector<quad>& legendre,
                   std::vector<quad>& sums);

/// Chooses the sign that makes the area positive and adds the basis' √2.
Coefficients finished(std::vector<quad> sums, int order);

}  // namespace shlight::truth
