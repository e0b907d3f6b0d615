// SPDX-License-Identifier: MIT
//
// What of a light lies above the horizon, as the arcs that bound it.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lobes/contour_integral.h"
#include "polygons/spherical_polygon.h"
#include "shlight/warp.h"

namespace shlight {

/// The outline of a cap above the horizon z = 0; empty where nothing is.
class CapOutline {
  public:
    explicit CapOutline(const Circle& cap);
    std::span<const OutlineArc> arcs() const { return std::span(arcs_).first(count_); }

  private:
    std::array<OutlineArc, 2> arcs_{};
    std::size_t count_ = 0;
};

/// The outline of a polygon that was clipped by the horizon.
std::vector<OutlineArc> polygon_outline(const SphericalPolygon& polygon);

}  // namespace shlight
