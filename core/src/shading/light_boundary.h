// SPDX-License-Identifier: MIT
//
// What of a light lies above the horizon, as the arcs that bound it.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lobes/boundary_integral.h"
#include "regions/spherical_polygon.h"
#include "shlight/cap.h"

namespace shlight {

/// The boundary of a cap above the horizon z = 0; empty where nothing is.
class CapBoundary {
  public:
    explicit CapBoundary(const SphericalCap& cap);
    std::span<const BoundaryArc> arcs() const { return std::span(arcs_).first(count_); }

  private:
    std::array<BoundaryArc, 2> arcs_{};
    std::size_t count_ = 0;
};

/// The boundary of a polygon that was clipped by the horizon.
std::vector<BoundaryArc> polygon_boundary(const SphericalPolygon& polygon);

}  // namespace shlight
