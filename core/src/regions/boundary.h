// SPDX-License-Identifier: MIT
//
// The boundaries of caps and polygons above the horizon z = 0, as arcs.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "regions/arcs.h"
#include "regions/spherical_polygon.h"
#include "shlight/cap.h"

namespace shlight {

/// The circle that bounds a cap, from wherever: half of its angle is π.
Arc<double> whole_circle(const SphericalCap& cap);

/// The boundary of what lies above the horizon of a cap; no arcs where nothing does.
class CapBoundary {
  public:
    explicit CapBoundary(const SphericalCap& cap);
    std::span<const Arc<double>> arcs() const { return std::span(arcs_).first(count_); }

  private:
    std::array<Arc<double>, 2> arcs_{};
    std::size_t count_ = 0;
};

/// The boundary of a polygon that was clipped by the horizon.
std::vector<Arc<double>> polygon_boundary(const SphericalPolygon& polygon);

}  // namespace shlight
