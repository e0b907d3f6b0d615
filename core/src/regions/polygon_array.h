// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace shlight {

/// Polygons of vertex_count vertices each, in double, one after the other.
struct PolygonArray {
    const double* vertices;
    std::size_t vertex_count;
};

}  // namespace shlight
